// A private folder that is removed with everything in it.
#pragma once

#include <string>
#include <utility>

#include "renderer/util/result.h"

namespace tessera {

// $TMPDIR, or what stands for it.
std::string TemporaryRoot();

class TemporaryFolder {
 public:
  // Creates it in $TMPDIR or /tmp, accessible to this user only. Removes those there whose processes were
  // killed.
  static Result<TemporaryFolder> Make();
  TemporaryFolder(TemporaryFolder&& other) noexcept
      : path_(std::exchange(other.path_, {})), lock_(std::exchange(other.lock_, -1)) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();
  const std::string& path() const { return path_; }

 private:
  TemporaryFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;
  int lock_;  // the folder itself, locked while it is used
};

}  // namespace tessera
