// Some rows of the picture, prepared for denoising.
#pragma once

#include <array>
#include <cstddef>
#include <stop_token>
#include <vector>

#include "renderer/denoise/input_layers.h"
#include "renderer/denoise/plane.h"
#include "renderer/util/result.h"

namespace tessera {

// Around a pixel: the pixels that it is compared with, and those around each that are compared (5 x 5).
constexpr int kWindowRadius = 7;
constexpr int kPatchRadius = 2;
constexpr int kStripMargin = kWindowRadius + kPatchRadius;

// Pixels are processed in tiles of this width and height; loops over a row of one are unrolled and
// vectorised.
constexpr int kTile = 32;
constexpr size_t kWide = 8;  // pixels that one instruction processes
static_assert(kTile % kWide == 0);

// Albedo and normal that guide (InputLayers), logarithm of the depth.
constexpr size_t kFeatures = 7;
constexpr size_t kSeenFeatures = 6;  // albedo and normal
constexpr size_t kAlbedoFeature = 0, kNormalFeature = 3, kDepthFeature = 6;

// The colours are divided by AlbedoFactor of their pixel, of the first surface: what mirrors and glass show
// has noise, which would remain in colours that are multiplied by it. Beyond the picture, up to kStripMargin
// pixels, the values are those of its mirror image.
struct Strip {
  std::array<std::array<Plane, kColors>, 2> halves;  // means of the samples of each half
  std::array<Plane, kColors> variance;               // of the means of one half
  std::array<Plane, kColors> mean;                   // of all samples
  std::array<Plane, kFeatures> features;
  // What albedo and normal that guide exceed those of the first surface by: 0 but for mirrors and glass.
  std::array<Plane, kSeenFeatures> beyond;
  std::array<Plane, kColors> albedo;
  std::vector<std::array<Plane, kColors>> groups;  // the light of each group, of all samples
};

// The albedo that counts for a pixel, of the value of its layer.
float UsableAlbedo(float value);

// What colours are divided by: the albedo, but not less than a part of it that is noise.
inline float AlbedoFactor(float albedo) {
  constexpr float kOffset = 0.02f;
  return albedo + kOffset;
}

// Fills strips of one picture, one after another.
class StripLoader {
 public:
  // `picture` outlives the loader.
  StripLoader(const LoadedPicture& picture, const InputLayers& layers);

  // Loads the rows from y0 to y1 and kStripMargin rows around them; (0, 0) is the first pixel of the data
  // window. Errors as those of ForEachItem.
  Result<void> Load(int y0, int y1, int threads, const std::stop_token& stop, Strip& strip);

 private:
  void Resize(int y0, int y1, Strip& strip);
  void LoadRow(int y, Strip& strip) const;
  void DarkenRow(int y, const Strip& strip);
  void DivideRow(int y, Strip& strip) const;
  void DivideGroups(int y, size_t c, Strip& strip) const;
  void SmoothRow(int y, Strip& strip) const;
  void AverageRow(int y, Strip& strip) const;

  const LoadedPicture& picture_;
  const InputLayers layers_;
  const int width_, height_;
  const float depth_max_;
  std::array<Plane, 2> darkening_;  // factors of the halves
};

}  // namespace tessera
