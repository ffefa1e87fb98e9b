// Pictures whose groups of lights are mixed anew. Each group has a layer of its own, "light_GROUP.R" and so
// on, and the picture is their sum.
#pragma once

#include <array>
#include <span>
#include <string>

#include "renderer/film/picture_file.h"

namespace tessera {

struct LightGain {
  std::string group;
  std::array<float, 3> rgb{1, 1, 1};
};

// The groups of the layers that a picture has, in alphabetical order.
std::vector<std::string> LightGroupsOf(const LoadedPicture& picture);

// The picture with the light of groups multiplied by gains; groups without one stay as they are. Has the
// layers that do not depend on light, and the scaled light of the groups. Fails if the picture lacks a colour
// or a group.
Result<LoadedPicture> Relight(const LoadedPicture& picture, std::span<const LightGain> gains);

// Makes colours, alpha and the light of groups channels of this type; others keep theirs.
void SetLightTypes(LoadedPicture& picture, ExrType type);

}  // namespace tessera
