#include "renderer/denoise/strip.h"

#include <algorithm>
#include <cmath>

#include "renderer/denoise/firefly.h"
#include "renderer/util/parallel.h"

namespace tessera {
namespace {

// Rows and columns that Load needs beyond those of a strip.
constexpr int kOuterMargin = kStripMargin + kSmoothRadius + kFireflyRadius;

// Squares of colours, and sums of them, stay finite.
constexpr float kColorMax = 1e15f;
// Albedos beyond this are errors of the scene; they would make features useless.
constexpr float kAlbedoMax = 4.0f;

float Finite(float value, float limit) {
  return std::isnan(value) ? 0 : std::clamp(value, -limit, limit);
}

// Filters make colours somewhat negative, errors of the scene far below that.
float UsableColor(float value) {
  constexpr float kDarkest = -1e4f;
  return value < kDarkest ? 0 : Finite(value, kColorMax);
}

}  // namespace

float UsableAlbedo(float value) {
  return std::max(0.0f, Finite(value, kAlbedoMax));
}

StripLoader::StripLoader(const LoadedPicture& picture, const InputLayers& layers)
    : picture_(picture),
      layers_(layers),
      width_(picture.bounds.width()),
      height_(picture.bounds.height()),
      depth_max_(LargestDepth(picture, layers.depth)) {}

void StripLoader::Resize(int y0, int y1, Strip& strip) {
  const auto resize = [&](Plane& plane) {
    // Tiles are read as a whole, the last ones of a row beyond the margin as well.
    plane.Resize(-kOuterMargin, width_ + 2 * kOuterMargin + kTile, y0 - kOuterMargin,
                 y1 - y0 + 2 * kOuterMargin);
  };
  for (auto& half : strip.halves) std::ranges::for_each(half, resize);
  std::ranges::for_each(strip.variance, resize);
  std::ranges::for_each(strip.mean, resize);
  std::ranges::for_each(strip.features, resize);
  std::ranges::for_each(strip.beyond, resize);
  std::ranges::for_each(strip.albedo, resize);
  strip.groups.resize(layers_.groups.size());
  for (auto& group : strip.groups) std::ranges::for_each(group, resize);
  std::ranges::for_each(darkening_, resize);
}

void StripLoader::LoadRow(int y, Strip& strip) const {
  const size_t channels = picture_.channels.size();
  const float* pixel =
      &picture_.values[static_cast<size_t>(Mirrored(y, height_)) * static_cast<size_t>(width_) * channels];
  for (int x = 0; x < width_; ++x, pixel += channels) {
    for (size_t c = 0; c < kColors; ++c) {
      const float color = pixel[layers_.color[c]], difference = pixel[layers_.halves[c]];
      *strip.halves[0][c].At(x, y) = UsableColor((color + difference) * layers_.half_scales[0]);
      *strip.halves[1][c].At(x, y) = UsableColor((color - difference) * layers_.half_scales[1]);
      *strip.albedo[c].At(x, y) = UsableAlbedo(pixel[layers_.albedo[c]]);
      *strip.features[kAlbedoFeature + c].At(x, y) = UsableAlbedo(pixel[layers_.guiding_albedo[c]]);
      *strip.features[kNormalFeature + c].At(x, y) = Finite(pixel[layers_.guiding_normal[c]], 1);
      *strip.beyond[kAlbedoFeature + c].At(x, y) =
          *strip.features[kAlbedoFeature + c].At(x, y) - *strip.albedo[c].At(x, y);
      *strip.beyond[kNormalFeature + c].At(x, y) =
          *strip.features[kNormalFeature + c].At(x, y) - Finite(pixel[layers_.normal[c]], 1);
    }
    for (size_t g = 0; g < layers_.groups.size(); ++g) {
      for (size_t c = 0; c < kColors; ++c)
        *strip.groups[g][c].At(x, y) = Finite(pixel[layers_.groups[g].color[c]], kColorMax);
    }
    // What is farther than everything counts as twice as far as the farthest surface.
    const float depth = pixel[layers_.depth];
    const float ratio = std::isfinite(depth) ? std::max(depth / depth_max_, 1e-4f) : 2.0f;
    *strip.features[kDepthFeature].At(x, y) = std::log(ratio);
  }
  for (auto& half : strip.halves) {
    for (Plane& plane : half) MirrorRow(plane, y, width_, kOuterMargin);
  }
  for (Plane& plane : strip.features) MirrorRow(plane, y, width_, kOuterMargin);
  for (Plane& plane : strip.beyond) MirrorRow(plane, y, width_, kOuterMargin);
  for (Plane& plane : strip.albedo) MirrorRow(plane, y, width_, kOuterMargin);
}

void StripLoader::DarkenRow(int y, const Strip& strip) {
  FindFireflies(strip, width_, y, darkening_);
}

// Groups lose the part of their light that the sum of the halves loses.
void StripLoader::DivideGroups(int y, size_t c, Strip& strip) const {
  const float *const a = strip.halves[0][c].At(0, y), *const b = strip.halves[1][c].At(0, y);
  const float *const darkening_a = darkening_[0].At(0, y), *const darkening_b = darkening_[1].At(0, y);
  const float* const albedo = strip.albedo[c].At(0, y);
  for (auto& group : strip.groups) {
    float* const row = group[c].At(0, y);
    for (int x = 0; x < width_; ++x) {
      const float all = a[x] + b[x];
      const float kept =
          all > 0 ? std::clamp((a[x] * darkening_a[x] + b[x] * darkening_b[x]) / all, 0.0f, 1.0f) : 1;
      row[x] *= kept / AlbedoFactor(albedo[x]);
    }
    MirrorRow(group[c], y, width_, kOuterMargin);
  }
}

void StripLoader::DivideRow(int y, Strip& strip) const {
  for (size_t c = 0; c < kColors; ++c) {
    DivideGroups(y, c, strip);
    for (size_t half = 0; half < 2; ++half) {
      const float* const darkening = darkening_[half].At(0, y);
      float* const row = strip.halves[half][c].At(0, y);
      const float* const albedo = strip.albedo[c].At(0, y);
      for (int x = 0; x < width_; ++x) row[x] *= darkening[x] / AlbedoFactor(albedo[x]);
      MirrorRow(strip.halves[half][c], y, width_, kOuterMargin);
    }
  }
}

// Half of the squared difference of two independent means estimates the variance of each; a single estimate
// says little, so those around are averaged.
void StripLoader::SmoothRow(int y, Strip& strip) const {
  for (size_t c = 0; c < kColors; ++c) {
    SmoothSquaredDifferences(strip.halves[0][c], strip.halves[1][c], y, width_, 0.5f, strip.variance[c]);
    MirrorRow(strip.variance[c], y, width_, kStripMargin);
  }
}

void StripLoader::AverageRow(int y, Strip& strip) const {
  const std::array<float, 2> shares = {0.5f / layers_.half_scales[0], 0.5f / layers_.half_scales[1]};
  for (size_t c = 0; c < kColors; ++c) {
    const float *const a = strip.halves[0][c].At(0, y), *const b = strip.halves[1][c].At(0, y);
    float* const mean = strip.mean[c].At(0, y);
    for (int x = 0; x < width_; ++x) mean[x] = shares[0] * a[x] + shares[1] * b[x];
    MirrorRow(strip.mean[c], y, width_, kStripMargin);
  }
}

Result<void> StripLoader::Load(int y0, int y1, int threads, const std::stop_token& stop, Strip& strip) {
  Resize(y0, y1, strip);
  // Calls `body` for the rows within `margin` of the strip.
  const auto for_rows = [&](int margin, const auto& body) {
    const int rows = y1 - y0 + 2 * margin;
    return ForEachItem(static_cast<size_t>(rows), threads, stop,
                       [&](size_t i) { body(y0 - margin + static_cast<int>(i)); });
  };
  constexpr int kInner = kStripMargin + kSmoothRadius;
  if (auto ok = for_rows(kOuterMargin, [&](int y) { LoadRow(y, strip); }); !ok) return ok;
  if (auto ok = for_rows(kInner, [&](int y) { DarkenRow(y, strip); }); !ok) return ok;
  if (auto ok = for_rows(kInner, [&](int y) { DivideRow(y, strip); }); !ok) return ok;
  return for_rows(kStripMargin, [&](int y) {
    SmoothRow(y, strip);
    AverageRow(y, strip);
  });
}

}  // namespace tessera
