#include "renderer/util/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>

#include "renderer/util/file_descriptor.h"
#include "renderer/util/readable_file.h"

namespace tessera {

Error SystemError(const std::string& path, const char* what) {
  return Failed(fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
}

Result<std::string> ReadFile(const std::string& path, uint64_t size_max) {
  const auto file = ReadableFile::Open(path);
  if (!file) return file.error();
  if (file->size() > size_max) {
    return BadInput(
        fmt::format("{}: holds {} bytes, more than the limit of {}", path, file->size(), size_max));
  }
  std::string bytes(file->size(), '\0');
  if (const auto read = file->Read(0, bytes); !read)
    return Failed(fmt::format("{}: cannot be read: {}", path, read.error().message));
  return bytes;
}

Result<std::string> Gunzip(std::string_view compressed, const std::string& path, uint64_t size_max) {
  const uint64_t limit = std::min(size_max, std::max(kGunzipFloor, compressed.size() * kGunzipRatioMax));
  z_stream stream{};
  constexpr int kGzipOnly = 15 + 16;  // the largest window, with a gzip header
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) return Failed(path + ": cannot start to decompress");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  size_t rest = compressed.size();
  std::string bytes;
  int status = Z_OK;
  char piece[1 << 16];
  while (status == Z_OK && bytes.size() <= limit) {
    if (stream.avail_in == 0) {
      constexpr size_t kFeedMax = size_t{1} << 30;  // zlib counts in 32 bits
      stream.avail_in = static_cast<uInt>(std::min(rest, kFeedMax));
      rest -= stream.avail_in;
    }
    stream.next_out = reinterpret_cast<Bytef*>(piece);
    stream.avail_out = sizeof piece;
    status = inflate(&stream, Z_NO_FLUSH);
    bytes.append(piece, sizeof piece - stream.avail_out);
    if (status == Z_STREAM_END && stream.avail_in + rest > 0)
      status = inflateReset(&stream);  // the next member
  }
  inflateEnd(&stream);
  if (bytes.size() > limit) {
    return BadInput(fmt::format("{}: unpacks to more than the limit of {} bytes{}", path, limit,
                                limit < size_max ? " for a file of its size" : ""));
  }
  if (status != Z_STREAM_END) return BadInput(path + ": the compressed data is damaged or cut short");
  return bytes;
}

Result<void> WriteFileAtomically(const std::string& path, std::string_view bytes, unsigned mode) {
  // Of this writer alone: others may be threads of this process, or processes of other containers, whose
  // numbers may be the same.
  std::random_device random;
  const std::string beside = fmt::format("{}.{:08x}{:08x}.tmp", path, random(), random());
  FileDescriptor file(::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  if (!file) return SystemError(path, "cannot be created");
  const bool written = WriteAll(file.number(), bytes) && ::fsync(file.number()) == 0 && file.Close();
  if (!written || ::rename(beside.c_str(), path.c_str()) != 0) {
    const Error error = SystemError(path, "cannot be written");
    ::unlink(beside.c_str());
    return error;
  }
  const size_t slash = path.rfind('/');
  return SyncFolder(slash == std::string::npos ? "." : path.substr(0, slash + 1));
}

Result<std::vector<std::string>> ListFolder(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    paths.push_back(it->path().string());
  if (error && error != std::errc::no_such_file_or_directory)
    return Failed(fmt::format("{}: cannot be listed: {}", folder, error.message()));
  return paths;
}

Result<void> SyncFolder(const std::string& folder) {
  FileDescriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // A folder may be writable and not readable; then nobody can sync it.
  if (!directory && errno == EACCES) return {};
  if (!directory) return SystemError(folder, "cannot be opened");
  if (::fsync(directory.number()) == 0) return {};
  // Some file systems cannot sync folders and do not need it.
  if (errno == EINVAL || errno == ENOTSUP) return {};
  return SystemError(folder, "cannot be synced");
}

Result<void> CreateFolders(const std::string& folder) {
  const auto exists = [&] {
    struct stat status {};
    return ::stat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
  };
  if (exists()) return {};
  const size_t last = folder.find_last_not_of('/');
  const size_t slash = last == std::string::npos ? last : folder.rfind('/', last);
  const std::string parent = slash == std::string::npos ? "." : folder.substr(0, slash + 1);
  if (parent.find_first_not_of('/') != std::string::npos) {
    if (auto made = CreateFolders(parent); !made) return made;
  }
  if (::mkdir(folder.c_str(), 0777) != 0 && !(errno == EEXIST && exists()))
    return SystemError(folder, "cannot be created");
  return SyncFolder(parent);
}

}  // namespace tessera
