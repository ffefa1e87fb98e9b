#include "language/file_source.h"

#include <fmt/format.h>

#include <filesystem>

#include "util/file.h"

namespace tessera {
namespace {

bool Exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

}  // namespace

Result<std::string> DiskFileSource::Read(const std::string& name) {
  if (name.empty()) return BadInput("a file name is empty");
  if (name.find('\0') != std::string::npos) return BadInput("a file name holds a zero byte");
  std::string path = name;
  if (name.front() != '/' && !folder_.empty()) {
    const std::string beside_scene = folder_ + "/" + name;
    if (Exists(beside_scene) || !Exists(name)) path = beside_scene;
  }
  Result<std::string> bytes = ReadFile(path, kSceneFileSizeMax);
  if (!bytes) return bytes;
  const File file{path, Sha256(*bytes), bytes->size()};
  const std::lock_guard lock(mutex_);
  const auto [entry, is_new] = files_.try_emplace(name, file);
  if (!is_new && entry->second.digest != file.digest) {
    return Failed(fmt::format("{}: changed while the scene was read: try again", path));
  }
  return bytes;
}

std::map<std::string, DiskFileSource::File> DiskFileSource::FilesRead() const {
  const std::lock_guard lock(mutex_);
  return files_;
}

}  // namespace tessera
