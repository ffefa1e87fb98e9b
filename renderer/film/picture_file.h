// Pictures to and from files.
#pragma once

#include <string>
#include <string_view>

#include "renderer/film/frame_spec.h"
#include "renderer/film/merger.h"

namespace tessera {

// The bytes of an OpenEXR file: display window from the spec, data window from its crop, attributes from the
// spec. Equal pictures give equal bytes.
Result<std::string> EncodeExr(const FrameSpec& spec, const FramePicture& picture);

// A decoded OpenEXR file: every channel as float.
struct LoadedPicture {
  int width = 0, height = 0;  // display window
  PixelBounds bounds;         // data window
  std::vector<std::string> channels;
  std::vector<float> values;                      // [(y * width + x) * channels + c] over the data window
  std::map<std::string, std::string> attributes;  // string attributes
};
Result<LoadedPicture> LoadExr(const std::string& path);
// Decodes the bytes of an OpenEXR file. Errors call them `name`.
Result<LoadedPicture> DecodeExr(std::string_view bytes, const std::string& name);

// The difference of two pictures over the channels that both have. relMSE is the mean of
// (a - b)^2 / (b^2 + 0.01), PSNR is for a peak of 1. Values that are not finite and not equal differ by
// infinity.
struct PictureDifference {
  double mse = 0, relmse = 0, psnr_db = 0, maxabs = 0;
  bool identical = false;  // same windows, same channels, same bits
};
// An error if the windows differ or there is no channel in common.
Result<PictureDifference> Compare(const LoadedPicture& a, const LoadedPicture& b);

}  // namespace tessera
