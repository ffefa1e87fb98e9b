// Names of files of which there is one for each frame: `scene.####.pbrt`, `shot/%03d/scene.pbrt`.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// Whether the name has a place for the frame's number.
bool IsFramePattern(std::string_view name);

// Every run of '#' becomes the number with as many digits at least, every "%d" and "%04d" what printf makes
// of it.
std::string NameOfFrame(std::string_view pattern, int number);

// The name itself if it is a pattern; else with ".####" before its ending: "out.exr" -> "out.####.exr".
std::string AsFramePattern(const std::string& name);

}  // namespace tessera
