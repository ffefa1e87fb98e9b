// The small picture in the header of an OpenEXR file, which file managers show.
#pragma once

#include <ImfPreviewImage.h>

#include <optional>
#include <span>
#include <string>

#include "renderer/film/frame_spec.h"

namespace tessera {

constexpr int kPreviewSizeMax = 96;  // pixels on the longer side

// sRGB, without tone mapping: each pixel is the mean of those that it stands for. Returns nullopt if the
// picture is no larger than a preview or has not all of R, G and B. `values` are interleaved.
std::optional<Imf::PreviewImage> MakePreviewImage(const PixelBounds& bounds,
                                                  std::span<const std::string> channels,
                                                  std::span<const float> values);

}  // namespace tessera
