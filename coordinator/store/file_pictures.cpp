#include "coordinator/store/file_pictures.h"

#include <fmt/format.h>

#include <filesystem>

#include "renderer/util/file.h"

namespace tessera {
namespace {

// 65536 x 65536 pixels hardly compress to more.
constexpr uint64_t kPictureBytesMax = uint64_t{32} << 30;

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
  if (Sha256(*bytes) != file.digest)
    return Failed(fmt::format("{}: is corrupt (SHA-256 mismatch)", PathOf(job, frame)));
  return bytes;
}

Result<std::string> FilePictures::ReadPartial(JobId job, uint32_t frame) const {
  auto bytes = ReadFile(PathOf(job, frame), kPictureBytesMax);
  if (!bytes) return Failed(bytes.error().message);
  return bytes;
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
