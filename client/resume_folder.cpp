#include "client/resume_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "proto/identity/private_file.h"
#include "renderer/util/digest.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

// Not in the cache of workers, which remove whatever they find there to make room.
Result<std::string> FolderOfRenders(const ResumeFolder::ReadVariable& environment) {
  if (const std::string cache = environment("XDG_CACHE_HOME"); !cache.empty())
    return cache + "/tessera-renders";
  if (const std::string home = environment("HOME"); !home.empty()) return home + "/.cache/tessera-renders";
  return BadInput("--resume: $XDG_CACHE_HOME or $HOME must name the folder that keeps what is rendered");
}

// Of everything that decides the picture and what this release makes of it.
Digest KeyOf(const PackedScene& scene) {
  std::string text = fmt::format("{} {}\n", kSoftwareVersion, scene.digest.Hex());
  for (const FrameRequest& frame : scene.frames)
    text += SceneKey(scene.digest, frame.scene_file, frame.options, frame.spec).Hex() +
            fmt::format(" {}\n", frame.number);
  return Sha256(text);
}

}  // namespace

Result<std::unique_ptr<ResumeFolder>> ResumeFolder::Open(const PackedScene& scene,
                                                         const ReadVariable& environment) {
  const auto parent = FolderOfRenders(environment);
  if (!parent) return parent.error();
  if (auto made = PreparePrivateFolder(*parent); !made) return made.error();
  const Digest key = KeyOf(scene);
  std::string path = *parent + "/" + key.Hex();
  if (auto made = PreparePrivateFolder(path); !made) return made.error();
  const int lock = ::open((path + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock < 0) return SystemError(path + "/lock", "cannot be opened");
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock);
    return Failed(fmt::format("{}: another process renders this scene with --resume", path));
  }
  std::error_code error;
  const bool has_data = std::filesystem::exists(path + "/coordinator", error);
  uint64_t submission = 0;
  std::memcpy(&submission, key.bytes.data(), sizeof submission);
  return std::unique_ptr<ResumeFolder>(new ResumeFolder(std::move(path), lock, has_data, submission | 1));
}

ResumeFolder::~ResumeFolder() {
  std::error_code ignored;
  if (is_finished_) std::filesystem::remove_all(path_, ignored);
  ::close(lock_);
}

}  // namespace tessera
