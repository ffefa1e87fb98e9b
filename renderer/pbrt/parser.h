// Reads pbrt-v4's scene language.
#pragma once

#include <string>

#include "renderer/description/file_source.h"
#include "renderer/description/scene_description.h"

namespace tessera {

// Parses the scene file `name` of `files` with all that it includes and imports. The first error ends it, as
// "file:line:column: what is wrong, what was expected".
Result<SceneDescription> ParseScene(FileSource& files, const std::string& name);

// The same for text in memory; `name` stands for its file in messages.
Result<SceneDescription> ParseSceneText(FileSource& files, const std::string& name, std::string text);

}  // namespace tessera
