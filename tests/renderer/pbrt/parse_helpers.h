// Helpers for tests of the scene language.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "renderer/pbrt/lexer.h"
#include "renderer/pbrt/parser.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

inline Result<SceneDescription> ParseText(const std::string& text) {
  MemoryFiles files;
  return ParseSceneText(files, "a.pbrt", text);
}

// The message of the error; "no error" if there is none.
inline std::string ErrorOf(const Result<SceneDescription>& scene) {
  return scene ? "no error" : scene.error().message;
}

// The parsed text, which must be good.
inline SceneDescription Parsed(const std::string& text) {
  Result<SceneDescription> scene = ParseText(text);
  EXPECT_TRUE(scene.has_value()) << ErrorOf(scene);
  return scene ? *std::move(scene) : SceneDescription();
}

}  // namespace tessera
