#include "renderer/denoise/denoise.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <new>
#include <optional>
#include <utility>

#include "renderer/denoise/denoised_picture.h"
#include "renderer/denoise/input_layers.h"
#include "renderer/denoise/local_regression.h"
#include "renderer/denoise/lost_light.h"
#include "renderer/denoise/oidn_denoiser.h"
#include "renderer/denoise/patch_weights.h"
#include "renderer/denoise/pilot.h"
#include "renderer/denoise/strip.h"
#include "renderer/denoise/strip_sums.h"
#include "renderer/denoise/temporal.h"
#include "renderer/util/parallel.h"

namespace tessera {
namespace {

static_assert(2 * kTile >= TileContributions::kSide, "every other tile writes to pixels of its own");

// The first pass: each half with the weights of the other, which are noisy. They are compared in larger
// patches, and differ by less than their noise.
constexpr WeightSettings kPilotWeights = {0.3f, 2};
constexpr float kPilotRidge = 3e-4f;
// The second pass: all samples with the weights of what the first one made of them.
constexpr WeightSettings kWeights = {1.0f, 1};
constexpr float kRidge = 2e-4f;

class PictureDenoiser {
 public:
  PictureDenoiser(const LoadedPicture& picture, const InputLayers& layers, int threads,
                  const std::stop_token& stop)
      : picture_(picture),
        layers_(layers),
        threads_(threads),
        stop_(stop),
        width_(picture.bounds.width()),
        height_(picture.bounds.height()),
        loader_(picture, layers),
        pilot_(width_, height_),
        signals_(kColors + layers.groups.size() * kColors) {}

  // DenoisedColors (denoised_picture.h).
  Result<std::vector<float>> Run() {
    if (auto ok = FirstPass(); !ok) return ok.error();
    colors_.resize(static_cast<size_t>(picture_.bounds.area()) * signals_);
    if (auto ok = SecondPass(); !ok) return ok.error();
    if (auto ok = ReturnLostLight(picture_, layers_, threads_, stop_, colors_); !ok) return ok.error();
    for (size_t pixel = 0; pixel < colors_.size() / signals_; ++pixel)
      SettleColors(&picture_.values[pixel * picture_.channels.size()], layers_, &colors_[pixel * signals_]);
    return std::move(colors_);
  }

 private:
  Result<void> FirstPass() {
    std::vector<StripSums> sums(2, StripSums(width_, kColors));
    const auto load = [&](int) -> Result<void> { return {}; };
    const auto filter = [&](const TilePlace& tile, int strip_y0) {
      PatchWeights weights;
      LocalRegression regression(kColors, kPilotRidge);
      for (size_t half = 0; half < 2; ++half) {
        TileContributions contributions(kColors);
        weights.Compute({strip_.halves[1 - half], strip_.variance}, kPilotWeights, tile);
        regression.Fit(strip_, Pointers(strip_.halves[half]), tile, weights, contributions);
        sums[half].Add(contributions, tile.x0, tile.y0 - strip_y0);
      }
    };
    const auto finish = [&](int y, int strip_y0) {
      for (size_t value = 0; value < Pilot::kValues; ++value)
        sums[value / kColors].FitRow(value % kColors, y - strip_y0, pilot_.Row(y) + value, Pilot::kValues);
    };
    return Pass(sums, load, filter, finish);
  }

  Result<void> SecondPass() {
    std::vector<StripSums> sums(1, StripSums(width_, signals_));
    const auto load = [&](int y) { return pilot_.Load(strip_, y, y + kStripHeight, threads_, stop_); };
    const auto filter = [&](const TilePlace& tile, int strip_y0) {
      std::vector<const Plane*> signals = Pointers(strip_.mean);
      for (const auto& group : strip_.groups) std::ranges::copy(Pointers(group), std::back_inserter(signals));
      PatchWeights weights;
      LocalRegression regression(signals_, kRidge);
      TileContributions contributions(signals_);
      weights.Compute(pilot_.guide(), kWeights, tile);
      regression.Fit(strip_, signals, tile, weights, contributions);
      sums[0].Add(contributions, tile.x0, tile.y0 - strip_y0);
    };
    const auto finish = [&](int y, int strip_y0) {
      float* const row = &colors_[static_cast<size_t>(y) * static_cast<size_t>(width_) * signals_];
      for (size_t s = 0; s < signals_; ++s) {
        sums[0].FitRow(s, y - strip_y0, row + s, signals_);
        const float* const albedo = strip_.albedo[s % kColors].At(0, y);
        for (int x = 0; x < width_; ++x)
          row[static_cast<size_t>(x) * signals_ + s] *= AlbedoFactor(albedo[x]);
      }
    };
    return Pass(sums, load, filter, finish);
  }

  // Calls load(y) for each strip, from row y on, filter(tile, y) for its tiles and finish(row, y) for the
  // rows that are complete.
  template <typename Load, typename Filter, typename Finish>
  Result<void> Pass(std::vector<StripSums>& sums, const Load& load, const Filter& filter,
                    const Finish& finish) {
    for (int y = 0; y < height_; y += kStripHeight) {
      // Strips are of equal height, so that a picture that grows at the bottom keeps its values.
      if (auto ok = loader_.Load(y, y + kStripHeight, threads_, stop_, strip_); !ok) return ok;
      if (auto ok = load(y); !ok) return ok;
      if (auto ok = FilterTiles(y, filter); !ok) return ok;
      // The last rows are complete only after the next strip.
      const int last = y + kStripHeight >= height_ ? height_ : y + kStripHeight - kWindowRadius;
      for (int row = std::max(y - kWindowRadius, 0); row < last; ++row) finish(row, y);
      for (StripSums& sum : sums) sum.NextStrip();
    }
    return {};
  }

  // Tiles whose neighbours are left out at first write to pixels of their own; so four rounds, of every other
  // tile along both axes, add up in a fixed order whatever thread takes a tile.
  template <typename Filter>
  Result<void> FilterTiles(int y0, const Filter& filter) {
    const int columns = (width_ + kTile - 1) / kTile;
    const int rows = (std::min(kStripHeight, height_ - y0) + kTile - 1) / kTile;
    for (int round = 0; round < 4; ++round) {
      const int column0 = round % 2, row0 = round / 2;
      const int columns_here = (columns - column0 + 1) / 2, rows_here = (rows - row0 + 1) / 2;
      const int tiles = columns_here * rows_here;
      auto done = ForEachItem(static_cast<size_t>(tiles), threads_, stop_, [&](size_t i) {
        const int column = column0 + 2 * (static_cast<int>(i) % columns_here);
        const int row = row0 + 2 * (static_cast<int>(i) / columns_here);
        filter(TilePlace{column * kTile, y0 + row * kTile, width_, height_}, y0);
      });
      if (!done) return done;
    }
    return {};
  }

  static std::vector<const Plane*> Pointers(const std::array<Plane, kColors>& planes) {
    std::vector<const Plane*> pointers;
    pointers.reserve(planes.size());
    for (const Plane& plane : planes) pointers.push_back(&plane);
    return pointers;
  }

  const LoadedPicture& picture_;
  const InputLayers& layers_;
  const int threads_;
  const std::stop_token& stop_;
  const int width_, height_;
  StripLoader loader_;
  Strip strip_;
  Pilot pilot_;
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
