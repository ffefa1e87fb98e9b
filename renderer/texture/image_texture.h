// The parameters of "imagemap".
#pragma once

#include <optional>

#include "renderer/description/diagnostics.h"
#include "renderer/image/image.h"
#include "renderer/texture/texture_assembly.h"

namespace tessera {

class ParameterReader;

// Reads the parameters and the image; the reader remembers errors, with the place of the parameter. `use` is
// that of a spectrum texture. Without it the texture is a float texture: its value is the grey value of the
// image, else its alpha (unless that is 1 everywhere), else the mean of red, green and blue. As in pbrt, the
// filters "point" and "ewa" of a float texture use only red. With `averages` the texture is the mean of the
// image everywhere.
std::optional<ImageTexture> ReadImageTexture(ParameterReader& reader, ImageCache& images,
                                             TextureAssembly& assembly, Diagnostics& diagnostics,
                                             std::optional<SpectrumUse> use, bool averages);

}  // namespace tessera
