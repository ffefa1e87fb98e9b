#include "store/blob_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "terms/terms.h"
#include "util/file.h"

namespace tessera {
namespace {

Error SystemError(const std::string& path, const char* what) {
  return Failed(fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
}

}  // namespace

Result<BlobStore> BlobStore::Open(const std::string& path) {
  std::error_code error;
  std::filesystem::remove_all(path + "/incoming", error);
  if (!error) std::filesystem::create_directories(path + "/incoming", error);
  if (error) return Failed(fmt::format("{}: cannot be made: {}", path, error.message()));
  return BlobStore(path);
}

// Two levels, so that no folder gets long.
std::string BlobStore::Folder(const Digest& digest) const {
  return path_ + "/" + digest.Hex().substr(0, 2);
}

std::string BlobStore::Path(const Digest& digest) const {
  return Folder(digest) + "/" + digest.Hex();
}

std::optional<uint64_t> BlobStore::Size(const Digest& digest) const {
  struct stat status {};
  if (::stat(Path(digest).c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return static_cast<uint64_t>(status.st_size);
}

Result<std::string> BlobStore::Read(const Digest& digest, uint64_t size_max) const {
  if (!Has(digest)) return BadInput(fmt::format("there is no blob {}", digest.Hex()));
  auto bytes = ReadFile(Path(digest), size_max);
  if (bytes && Sha256(*bytes) != digest)
    return Failed(Path(digest) + ": is damaged: its bytes are not its digest's");
  return bytes;
}

Result<void> BlobStore::Write(const Digest& digest, std::string_view bytes) const {
  auto upload = Begin(digest, bytes.size());
  if (!upload) return upload.error();
  if (const auto added = (*upload)->Add(bytes); !added) return added.error();
  return (*upload)->Finish();
}

Result<std::unique_ptr<BlobStore::Upload>> BlobStore::Begin(const Digest& digest, uint64_t size) const {
  if (size > kBlobBytesMax)
    return BadInput(fmt::format("blob {}: {} bytes are too many", digest.Hex(), size));
  std::unique_ptr<Upload> upload(new Upload);
  upload->digest_ = digest;
  upload->size_ = size;
  upload->folder_ = Folder(digest);
  upload->path_ = Path(digest);
  upload->temporary_ = fmt::format("{}/incoming/{}.XXXXXX", path_, digest.Hex());
  upload->file_ = ::mkostemp(upload->temporary_.data(), O_CLOEXEC);
  if (upload->file_ < 0) return SystemError(upload->temporary_, "cannot be created");
  return upload;
}

BlobStore::Upload::~Upload() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(temporary_.c_str());
}

Result<void> BlobStore::Upload::Add(std::string_view bytes) {
  received_ += bytes.size();
  if (received_ > size_) return BadInput(fmt::format("blob {}: more bytes than announced", digest_.Hex()));
  hash_.Add(bytes);
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return SystemError(temporary_, "cannot be written");
    bytes.remove_prefix(static_cast<size_t>(count));
  }
  return {};
}

Result<void> BlobStore::Upload::Finish() {
  if (received_ != size_) {
    return BadInput(fmt::format("blob {}: {} bytes instead of {}", digest_.Hex(), received_, size_));
  }
  if (hash_.Finish() != digest_)
    return BadInput(fmt::format("blob {}: its bytes are not its digest's", digest_.Hex()));
  if (::mkdir(folder_.c_str(), 0755) != 0 && errno != EEXIST) return SystemError(folder_, "cannot be made");
  if (::fsync(file_) != 0) return SystemError(temporary_, "cannot be synced");
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return SystemError(path_, "cannot be written");
  ::close(file_);
  file_ = -1;  // nothing to drop any more
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return {};
}

}  // namespace tessera
