#include "renderer/description/file_source.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>

#include "renderer/util/file.h"

namespace tessera {
namespace {

bool Exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

// The key of what a file on disk is now: changes when the file does. Empty if there is none.
std::string StateOf(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  return fmt::format("file\n{}\n{} {} {} {}.{:09}", path, status.st_dev, status.st_ino, status.st_size,
                     status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

}  // namespace

std::string DiskFileSource::PathOf(const std::string& name) const {
  if (name.empty() || name.front() == '/' || folder_.empty()) return name;
  const std::string beside_scene = folder_ + "/" + name;
  return Exists(beside_scene) || !Exists(name) ? beside_scene : name;
}

bool DiskFileSource::Remember(const std::string& name, const File& file) {
  const std::lock_guard lock(mutex_);
  const auto [entry, is_new] = files_.try_emplace(name, file);
  return is_new || entry->second.digest == file.digest;
}

Result<std::string> DiskFileSource::Read(const std::string& name) {
  if (name.empty()) return BadInput("a file name is empty");
  if (name.find('\0') != std::string::npos) return BadInput("a file name holds a zero byte");
  const std::string path = PathOf(name);
  const std::string state = cache() != nullptr ? StateOf(path) : std::string();
  Result<std::string> bytes = ReadFile(path, kSceneFileSizeMax);
  if (!bytes) return bytes;
  const File file{path, Sha256(*bytes), bytes->size()};
  if (!Remember(name, file)) {
    return Failed(fmt::format("{}: changed while the scene was being read; run the command again", path));
  }
  if (!state.empty())
    cache()->Keep(state, std::make_shared<const File>(file), sizeof(File) + 2 * state.size());
  return bytes;
}

std::optional<Digest> DiskFileSource::Identify(const std::string& name) {
  const std::string state = StateOf(PathOf(name));
  const auto file = state.empty() ? nullptr : cache()->Find<File>(state);
  if (file == nullptr || !Remember(name, *file)) return std::nullopt;
  return file->digest;
}

std::map<std::string, DiskFileSource::File> DiskFileSource::FilesRead() const {
  const std::lock_guard lock(mutex_);
  return files_;
}

}  // namespace tessera
