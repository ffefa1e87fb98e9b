// Helpers for tests of the scene language.
#pragma once

#include <map>
#include <string>

#include "renderer/pbrt/lexer.h"
#include "renderer/pbrt/parser.h"

namespace tessera {

// Files in memory.
class MemoryFileSource : public FileSource {
 public:
  std::map<std::string, std::string> files;

  Result<std::string> Read(const std::string& name) override {
    const auto found = files.find(name);
    if (found == files.end()) return BadInput(name + ": cannot be opened: No such file or directory");
    return found->second;
  }
};

inline Result<SceneDescription> ParseText(const std::string& text) {
  MemoryFileSource files;
  return ParseSceneText(files, "a.pbrt", text);
}

// The message of the error; "no error" if there is none.
inline std::string ErrorOf(const Result<SceneDescription>& scene) {
  return scene ? "no error" : scene.error().message;
}

}  // namespace tessera
