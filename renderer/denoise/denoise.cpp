#include "renderer/denoise/denoise.h"

#include <algorithm>
#include <array>
#include <memory>
#include <new>

#include "renderer/denoise/input_layers.h"
#include "renderer/denoise/local_regression.h"
#include "renderer/denoise/patch_weights.h"
#include "renderer/denoise/strip.h"
#include "renderer/util/parallel.h"

namespace tessera {
namespace {

// Rows of a strip. Its margins, which are loaded twice, are a seventh of it.
constexpr int kStripHeight = 6 * kTile;
static_assert(2 * kTile >= TileContributions::kSide, "every other tile writes to pixels of its own");

// The sums that pixels of a strip and of kWindowRadius rows around it have received.
class StripSums {
 public:
  explicit StripSums(int width) : width_(width) {
    for (Plane& plane : sums_) plane.Resize(0, width, -kWindowRadius, kRows);
    Clear(-kWindowRadius, kRows);
  }
  // Moves on to the next strip. Its first rows have received from the last one.
  void NextStrip() {
    for (Plane& plane : sums_) {
      for (int y = -kWindowRadius; y < kWindowRadius; ++y)
        std::copy_n(plane.At(0, y + kStripHeight), width_, plane.At(0, y));
    }
    Clear(kWindowRadius, kRows - 2 * kWindowRadius);
  }
  // Adds what a tile contributes; `y0` counts from the strip's first row.
  void Add(const TileContributions& tile, int x0, int y0) {
    constexpr int kSide = TileContributions::kSide;
    const int first = std::max(0, kWindowRadius - x0);
    const int last = std::min(kSide, width_ - x0 + kWindowRadius);
    for (size_t c = 0; c <= kColors; ++c) {
      for (int y = 0; y < kSide; ++y) {
        float* const to = sums_[c].At(x0 - kWindowRadius + first, y0 + y - kWindowRadius);
        const float* const from = &tile.sums[c][static_cast<size_t>(y)][static_cast<size_t>(first)];
        for (int x = 0; x < last - first; ++x) to[x] += from[x];
      }
    }
  }
  const Plane& operator[](size_t c) const { return sums_[c]; }

 private:
  static constexpr int kRows = kStripHeight + 2 * kWindowRadius;

  void Clear(int y0, int rows) {
    for (Plane& plane : sums_)
      std::fill_n(plane.At(0, y0), static_cast<size_t>(rows) * static_cast<size_t>(width_), 0.0f);
  }

  const int width_;
  std::array<Plane, kColors + 1> sums_;
};

class PictureDenoiser {
 public:
  PictureDenoiser(const LoadedPicture& picture, const InputLayers& layers, int threads,
                  const std::stop_token& stop)
      : picture_(picture),
        layers_(layers),
        threads_(threads),
        stop_(stop),
        loader_(picture, layers),
        sums_(picture.bounds.width()) {}

  // Three values for each pixel.
  Result<std::vector<float>> Run() {
    const int height = picture_.bounds.height();
    colors_.resize(static_cast<size_t>(picture_.bounds.area()) * kColors);
    for (int y = 0; y < height; y += kStripHeight) {
      // Strips are of equal height, so that a picture that grows at the bottom keeps its values.
      if (auto ok = loader_.Load(y, y + kStripHeight, threads_, stop_, strip_); !ok) return ok.error();
      if (auto ok = DenoiseStrip(y); !ok) return ok.error();
      // The last rows are complete only after the next strip.
      Finish(y - kWindowRadius, y + kStripHeight >= height ? height : y + kStripHeight - kWindowRadius, y);
      sums_.NextStrip();
    }
    return std::move(colors_);
  }

 private:
  // Tiles whose neighbours are left out at first write to pixels of their own; so four rounds, of every other
  // tile along both axes, add up in a fixed order whatever thread takes a tile.
  Result<void> DenoiseStrip(int y0) {
    const int columns = (picture_.bounds.width() + kTile - 1) / kTile;
    const int rows = (std::min(kStripHeight, picture_.bounds.height() - y0) + kTile - 1) / kTile;
    for (int round = 0; round < 4; ++round) {
      const int column0 = round % 2, row0 = round / 2;
      const int columns_here = (columns - column0 + 1) / 2, rows_here = (rows - row0 + 1) / 2;
      auto done = ForEachItem(static_cast<size_t>(columns_here * rows_here), threads_, stop_, [&](size_t i) {
        const int column = column0 + 2 * (static_cast<int>(i) % columns_here);
        const int row = row0 + 2 * (static_cast<int>(i) / columns_here);
        DenoiseTile(y0, column * kTile, row * kTile);
      });
      if (!done) return done;
    }
    return {};
  }

  void DenoiseTile(int strip_y0, int x, int y) {
    const TilePlace tile{x, strip_y0 + y, picture_.bounds.width(), picture_.bounds.height()};
    PatchWeights weights;
    LocalRegression regression;
    const auto contributions = std::make_unique<TileContributions>();
    for (size_t half = 0; half < 2; ++half) {
      weights.Compute(strip_, 1 - half, tile);
      regression.Fit(strip_, half, tile, weights, *contributions);
    }
    sums_.Add(*contributions, x, y);
  }

  // Stores the colours of rows y0 to y1 from the sums of the strip that starts at strip_y0.
  void Finish(int y0, int y1, int strip_y0) {
    const size_t channels = picture_.channels.size();
    for (int y = std::max(y0, 0); y < y1; ++y) {
      const size_t row = static_cast<size_t>(y) * static_cast<size_t>(picture_.bounds.width());
      const float* const weight = sums_[kColors].At(0, y - strip_y0);
      for (size_t c = 0; c < kColors; ++c) {
        const float* const sum = sums_[c].At(0, y - strip_y0);
        const float* const albedo = strip_.features[kAlbedoFeature + c].At(0, y);
        for (size_t x = 0; x < static_cast<size_t>(picture_.bounds.width()); ++x) {
          const float noisy = picture_.values[(row + x) * channels + layers_.color[c]];
          const float color = sum[x] / std::max(weight[x], kWeightMin) * AlbedoFactor(albedo[x]);
          // A fit may be negative where the colour is not.
          colors_[(row + x) * kColors + c] = std::max(color, noisy < 0 ? noisy : 0.0f);
        }
      }
    }
  }

  static constexpr float kWeightMin = 1e-20f;

  const LoadedPicture& picture_;
  const InputLayers& layers_;
  const int threads_;
  const std::stop_token& stop_;
  StripLoader loader_;
  Strip strip_;
  StripSums sums_;
  std::vector<float> colors_;
};

// The picture with the denoised colours as R, G and B and the others kept in the layer "noisy".
LoadedPicture WithColors(const LoadedPicture& picture, const InputLayers& layers,
                         const std::vector<float>& colors) {
  LoadedPicture result;
  result.width = picture.width;
  result.height = picture.height;
  result.bounds = picture.bounds;
  result.attributes = picture.attributes;
  constexpr const char* kNames[] = {"R", "G", "B"};
  std::vector<size_t> kept;  // channels
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    const bool is_color = std::ranges::find(layers.color, c) != layers.color.end();
    if (!is_color && !IsColorChannel(picture.channels[c])) kept.push_back(c);
  }
  for (const size_t c : kept) result.channels.push_back(picture.channels[c]);
  for (const char* name : kNames) result.channels.emplace_back(name);
  for (const char* name : kNames) result.channels.push_back(std::string(kNoisyLayer) + "." + name);
  const size_t pixels = static_cast<size_t>(picture.bounds.area());
  result.values.reserve(pixels * result.channels.size());
  for (size_t i = 0; i < pixels; ++i) {
    const float* const pixel = &picture.values[i * picture.channels.size()];
    for (const size_t c : kept) result.values.push_back(pixel[c]);
    for (size_t c = 0; c < kColors; ++c) result.values.push_back(colors[i * kColors + c]);
    for (const size_t c : layers.color) result.values.push_back(pixel[c]);
  }
  return result;
}

}  // namespace

Result<void> CheckDenoisable(const LoadedPicture& picture, const std::string& name) {
  const auto layers = FindInputLayers(picture, name);
  return layers ? Result<void>() : layers.error();
}

Result<LoadedPicture> Denoise(const LoadedPicture& picture, const std::string& name, int threads,
                              const std::stop_token& stop) {
  const auto layers = FindInputLayers(picture, name);
  if (!layers) return layers.error();
  try {
    auto colors = PictureDenoiser(picture, *layers, threads, stop).Run();
    if (!colors) return colors.error();
    return WithColors(picture, *layers, *colors);
  } catch (const std::bad_alloc&) {
    return Failed(name + ": not enough memory to denoise the picture");
  }
}

}  // namespace tessera
