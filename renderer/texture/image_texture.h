// The parameters of "imagemap".
#pragma once

#include <optional>

#include "renderer/image/image.h"
#include "renderer/texture/texture_assembly.h"

namespace tessera {

class ParameterReader;

// Reads the picture and its parameters; errors are remembered by the reader, at the parameter concerned.
// `use` is that of a spectrum texture; nothing means a float texture: its value is the picture's grey value,
// else its alpha (if that is not 1 everywhere), else the mean of red, green and blue. As in pbrt, the filters
// "point" and "ewa" of a float texture see only red.
std::optional<ImageTexture> ReadImageTexture(ParameterReader& reader, ImageCache& images,
                                             TextureAssembly& assembly, std::optional<SpectrumUse> use);

}  // namespace tessera
