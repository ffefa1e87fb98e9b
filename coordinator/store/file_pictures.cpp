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
  std::error_code error;
  std::filesystem::create_directories(FolderOf(job), error);
  if (error) return Failed(fmt::format("{}: cannot be created: {}", FolderOf(job), error.message()));
  return WriteFileAtomically(PathOf(job, frame), bytes);
}

Result<std::string> FilePictures::Read(JobId job, uint32_t frame) const {
  auto bytes = ReadFile(PathOf(job, frame), kPictureBytesMax);
  if (!bytes) return Failed(bytes.error().message);
  return bytes;
}

void FilePictures::Remove(JobId job) {
  std::error_code ignored;
  std::filesystem::remove_all(FolderOf(job), ignored);
}

}  // namespace tessera
