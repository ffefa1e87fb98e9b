// A FileSource over text in memory.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "renderer/description/file_source.h"

namespace tessera {

class MemoryFiles : public FileSource {
 public:
  MemoryFiles() = default;
  explicit MemoryFiles(std::map<std::string, std::string> the_files,
                       std::shared_ptr<SharedCache> cache = nullptr)
      : FileSource(std::move(cache)), files(std::move(the_files)) {}

  Result<std::string> Read(const std::string& name) override {
    ++reads;
    const auto found = files.find(name);
    if (found == files.end()) return BadInput(name + ": cannot be opened: No such file or directory");
    return found->second;
  }
  std::optional<Digest> Identify(const std::string& name) override {
    const auto found = files.find(name);
    return found == files.end() ? std::nullopt : std::optional(Sha256(found->second));
  }

  std::map<std::string, std::string> files;
  int reads = 0;  // calls of Read
};

}  // namespace tessera
