// A FileSource over text in memory, for tests.
#pragma once

#include <map>
#include <string>

#include "renderer/description/file_source.h"

namespace tessera {

class MemoryFiles : public FileSource {
 public:
  explicit MemoryFiles(std::map<std::string, std::string> files) : files_(std::move(files)) {}
  Result<std::string> Read(const std::string& name) override {
    const auto found = files_.find(name);
    if (found == files_.end()) return BadInput(name + ": cannot be opened: no such file");
    return found->second;
  }

 private:
  std::map<std::string, std::string> files_;
};

}  // namespace tessera
