// The media of a scene text.
#pragma once

#include <string>

#include "renderer/medium/medium.h"
#include "renderer/pbrt/parser.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

struct BuiltMedia {
  MediumTable table;
  std::string error;
  Diagnostics diagnostics;
};

// `media` starts in line 3 of the file m.pbrt.
inline BuiltMedia BuildMedia(const std::string& media, std::map<std::string, std::string> the_files = {}) {
  MemoryFiles files(std::move(the_files));
  BuiltMedia built;
  Result<SceneDescription> scene =
      ParseSceneText(files, "m.pbrt", "Camera \"perspective\"\nWorldBegin\n" + media);
  if (!scene) {
    built.error = scene.error().message;
    return built;
  }
  Result<MediumTable> table = MediumTable::Build(*scene, Transform(), files, built.diagnostics);
  if (table)
    built.table = std::move(*table);
  else
    built.error = table.error().message;
  return built;
}

}  // namespace tessera
