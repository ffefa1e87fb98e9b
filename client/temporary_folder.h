// A private folder that is removed with everything in it.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "renderer/util/result.h"

namespace tessera {

class TemporaryFolder {
 public:
  // Creates it in $TMPDIR or /tmp, accessible to this user only.
  static Result<TemporaryFolder> Make();
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;
};

}  // namespace tessera
