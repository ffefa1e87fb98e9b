#include "renderer/denoise/denoise.h"

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "renderer/denoise/denoised_picture.h"
#include "renderer/denoise/input_layers.h"
#include "renderer/denoise/local_regression.h"
#include "renderer/denoise/oidn_denoiser.h"
#include "renderer/denoise/patch_weights.h"
#include "renderer/denoise/strip.h"
#include "renderer/denoise/temporal.h"
#include "renderer/util/parallel.h"

namespace tessera {
namespace {

// Rows of a strip. Its margins, which are loaded twice, are a seventh of it.
constexpr int kStripHeight = 6 * kTile;
static_assert(2 * kTile >= TileContributions::kSide, "every other tile writes to pixels of its own");

// The sums that pixels of a strip and of kWindowRadius rows around it have received.
class StripSums {
 public:
  StripSums(int width, size_t groups) : width_(width), sums_(TileContributions::SumCount(groups)) {
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
    for (size_t c = 0; c < sums_.size(); ++c) {
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
  std::vector<Plane> sums_;
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
        sums_(picture.bounds.width(), layers.groups.size()),
        signals_(kColors + layers.groups.size() * kColors) {}

  // DenoisedColors (denoised_picture.h).
  Result<std::vector<float>> Run() {
    const int height = picture_.bounds.height();
    colors_.resize(static_cast<size_t>(picture_.bounds.area()) * signals_);
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
      const int tiles = columns_here * rows_here;
      auto done = ForEachItem(static_cast<size_t>(tiles), threads_, stop_, [&](size_t i) {
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
    LocalRegression regression(layers_.groups.size());
    TileContributions contributions(layers_.groups.size());
    for (size_t half = 0; half < 2; ++half) {
      weights.Compute(strip_, 1 - half, tile);
      regression.Fit(strip_, half, tile, weights, contributions);
    }
    sums_.Add(contributions, x, y);
  }

  // Stores the colours of rows y0 to y1 from the sums of the strip that starts at strip_y0.
  void Finish(int y0, int y1, int strip_y0) {
    const auto width = static_cast<size_t>(picture_.bounds.width());
    for (int y = std::max(y0, 0); y < y1; ++y) {
      float* const row = &colors_[static_cast<size_t>(y) * width * signals_];
      const float* const weight = sums_[TileContributions::kWeight].At(0, y - strip_y0);
      for (size_t s = 0; s < signals_; ++s) {
        const float* const sum = sums_[s < kColors ? s : s + 1].At(0, y - strip_y0);
        const float* const albedo = strip_.albedo[s % kColors].At(0, y);
        for (size_t x = 0; x < width; ++x)
          row[x * signals_ + s] = sum[x] / std::max(weight[x], kWeightMin) * AlbedoFactor(albedo[x]);
      }
      for (size_t x = 0; x < width; ++x) {
        const size_t pixel = static_cast<size_t>(y) * width + x;
        SettleColors(&picture_.values[pixel * picture_.channels.size()], layers_, row + x * signals_);
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
  const size_t signals_;  // values of a pixel: colours, then those of each group
  std::vector<float> colors_;
};

}  // namespace

Result<void> CheckDenoisable(const LoadedPicture& picture, const std::string& name, Denoiser denoiser) {
  const auto layers = FindInputLayers(picture, name, denoiser);
  return layers ? Result<void>() : layers.error();
}

namespace {

// May throw std::bad_alloc.
Result<DenoisedColors> ColorsOf(const LoadedPicture& picture, const InputLayers& layers,
                                const std::string& name, int threads, const std::stop_token& stop,
                                Denoiser denoiser) {
  if (denoiser == Denoiser::kOidn) return DenoiseWithOidn(picture, layers, name, threads, stop);
  auto values = PictureDenoiser(picture, layers, threads, stop).Run();
  if (!values) return values.error();
  return DenoisedColors{std::move(values).value(), "regression"};
}

Error LacksMemory(const std::string& name) {
  return Failed(name + ": not enough memory to denoise the picture");
}

std::optional<std::array<size_t, 2>> FindMotion(const LoadedPicture& picture) {
  const auto x = std::ranges::find(picture.channels, "motion.X"),
             y = std::ranges::find(picture.channels, "motion.Y");
  if (x == picture.channels.end() || y == picture.channels.end()) return std::nullopt;
  return std::array{static_cast<size_t>(x - picture.channels.begin()),
                    static_cast<size_t>(y - picture.channels.begin())};
}

}  // namespace

Result<LoadedPicture> Denoise(const LoadedPicture& picture, const std::string& name, int threads,
                              const std::stop_token& stop, Denoiser denoiser) {
  const auto layers = FindInputLayers(picture, name, denoiser);
  if (!layers) return layers.error();
  try {
    const auto colors = ColorsOf(picture, *layers, name, threads, stop, denoiser);
    if (!colors) return colors.error();
    return WithColors(picture, *layers, *colors);
  } catch (const std::bad_alloc&) {
    return LacksMemory(name);
  }
}

Result<DenoisedFrame> DenoiseAlone(LoadedPicture picture, const std::string& name, int threads,
                                   const std::stop_token& stop, Denoiser denoiser) {
  auto layers = FindInputLayers(picture, name, denoiser);
  if (!layers) return layers.error();
  try {
    auto colors = ColorsOf(picture, *layers, name, threads, stop, denoiser);
    if (!colors) return colors.error();
    const auto motion = FindMotion(picture);
    return DenoisedFrame{std::move(picture), std::move(layers).value(), motion, std::move(colors).value()};
  } catch (const std::bad_alloc&) {
    return LacksMemory(name);
  }
}

}  // namespace tessera
