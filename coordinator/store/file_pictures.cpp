#include "coordinator/store/file_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "renderer/util/file.h"

namespace tessera {
namespace {

// 65536 x 65536 pixels hardly compress to more.
constexpr uint64_t kPictureBytesMax = uint64_t{32} << 30;
constexpr uint64_t kPieceBytes = uint64_t{1} << 20;

Result<ReadableFile> OpenFile(const std::string& path) {
  auto file = ReadableFile::Open(path);
  if (file) return file;
  const auto& [kind, message] = file.error();
  return Error{kind == ErrorKind::kFailed ? ErrorKind::kInterrupted : ErrorKind::kFailed, message};
}

Error CannotBeRead(const std::string& path, const Error& error) {
  return Failed(fmt::format("{}: cannot be read: {}", path, error.message));
}

Error Mismatch(const std::string& path) {
  return Failed(fmt::format("{}: is corrupt (SHA-256 mismatch)", path));
}

Result<Digest> DigestOf(const ReadableFile& file, const std::string& path) {
  Sha256Stream hash;
  std::string piece;
  for (uint64_t at = 0; at < file.size(); at += piece.size()) {
    piece.resize(std::min(kPieceBytes, file.size() - at));
    if (const auto read = file.Read(at, piece); !read) return CannotBeRead(path, read.error());
    if (piece.empty()) return Failed(fmt::format("{}: is shorter than it was", path));
    hash.Add(piece);
  }
  return hash.Finish();
}

}  // namespace

std::string FilePictures::FolderOf(JobId job) const {
  return fmt::format("{}/{}", folder_, Number(job));
}

std::string FilePictures::PathOf(JobId job, uint32_t frame) const {
  return fmt::format("{}/{}.exr", FolderOf(job), frame);
}

Result<void> FilePictures::Write(JobId job, uint32_t frame, std::string_view bytes) {
  if (auto made = CreateFolders(FolderOf(job)); !made) return made;
  return WriteFileAtomically(PathOf(job, frame), bytes);
}

Result<std::string> FilePictures::Read(JobId job, uint32_t frame, const PictureFile& file) const {
  if (const auto probed = Probe(job, frame, file); !probed) return probed.error();
  auto bytes = ReadPartial(job, frame);
  if (!bytes) return bytes;
  if (Sha256(*bytes) != file.digest) return Mismatch(PathOf(job, frame));
  return bytes;
}

Result<std::string> FilePictures::ReadPartial(JobId job, uint32_t frame) const {
  const std::string path = PathOf(job, frame);
  const auto file = OpenFile(path);
  if (!file) return file.error();
  if (file->size() > kPictureBytesMax)
    return Failed(fmt::format("{}: holds {} bytes, more than any picture", path, file->size()));
  std::string bytes(file->size(), '\0');
  if (const auto read = file->Read(0, bytes); !read) return CannotBeRead(path, read.error());
  return bytes;
}

Result<StoredPicture> FilePictures::Open(JobId job, uint32_t frame,
                                         const std::optional<PictureFile>& file) const {
  if (file) {
    if (const auto probed = Probe(job, frame, *file); !probed) return probed.error();
  }
  const std::string path = PathOf(job, frame);
  auto opened = OpenFile(path);
  if (!opened) return opened.error();
  const auto digest = DigestOf(*opened, path);
  if (!digest) return digest.error();
  if (file && *digest != file->digest) return Mismatch(path);
  return StoredPicture{std::move(*opened), *digest};
}

Result<void> FilePictures::Probe(JobId job, uint32_t frame, const PictureFile& file) const {
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(PathOf(job, frame), error);
  if (error) return Failed(fmt::format("{}: cannot be opened: {}", PathOf(job, frame), error.message()));
  if (file.bytes == 0 || bytes == file.bytes) return {};
  return Failed(
      fmt::format("{}: is corrupt ({} bytes instead of {})", PathOf(job, frame), bytes, file.bytes));
}

void FilePictures::Remove(JobId job) {
  std::error_code ignored;
  std::filesystem::remove_all(FolderOf(job), ignored);
}

}  // namespace tessera
