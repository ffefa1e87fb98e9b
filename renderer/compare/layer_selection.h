// Layers of a picture by the convention of OpenEXR: channel "albedo.R" belongs to the layer "albedo".
#pragma once

#include <string>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

// The layer of channels whose names have no dot and that are R, G, B or A.
constexpr const char* kColorLayer = "RGB";

// The names of the layers that these channels make, in order, each once. A channel that belongs to no other
// layer is a layer of its own.
std::vector<std::string> LayersOf(const std::vector<std::string>& channels);

// The picture with the channels of one layer alone. Those of "albedo" keep the last part of their names: R,
// G and B. The error lists the layers of the picture, which it calls `name`.
Result<LoadedPicture> SelectLayer(const LoadedPicture& picture, const std::string& layer,
                                  const std::string& name);

}  // namespace tessera
