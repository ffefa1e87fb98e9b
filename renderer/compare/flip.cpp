#include "renderer/compare/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/compare/exposures.h"
#include "renderer/compare/flip_filters.h"
#include "renderer/util/parallel.h"

namespace tessera {
namespace {

// Exponents of colour and feature differences, and the two that map colour differences to errors: those of
// up to kKnee of the largest one become errors of up to kKneeError.
constexpr float kColorExponent = 0.7f, kFeatureExponent = 0.5f;
constexpr float kKnee = 0.4f, kKneeError = 0.95f;

// sRGB to XYZ under D65, as the reference implementation of the papers writes the matrix and its inverse,
// and the white point.
constexpr float kToXyz[3][3] = {{10135552 / 24577794.0f, 8788810 / 24577794.0f, 4435075 / 24577794.0f},
                                {2613072 / 12288897.0f, 8788810 / 12288897.0f, 887015 / 12288897.0f},
                                {1425312 / 73733382.0f, 8788810 / 73733382.0f, 70074185 / 73733382.0f}};
constexpr float kFromXyz[3][3] = {{3.241003275f, -1.537398934f, -0.498615861f},
                                  {-0.969224334f, 1.875930071f, 0.041554224f},
                                  {0.055639423f, -0.204011202f, 1.057148933f}};
constexpr float kWhite[3] = {0.950428545f, 1.0f, 1.088900371f};

constexpr int kTileWidth = 256, kTileHeight = 64;  // of the pixels that one thread takes: its values fit L2

using Triple = std::array<float, 3>;

Triple Times(const float (&matrix)[3][3], const Triple& v) {
  Triple product;
  for (size_t i = 0; i < 3; ++i) product[i] = matrix[i][0] * v[0] + matrix[i][1] * v[1] + matrix[i][2] * v[2];
  return product;
}

// To and from YCxCz, a linear version of L*a*b* (Kolpatzik and Bouman 1992).
Triple ToOpponent(const Triple& rgb) {
  const Triple xyz = Times(kToXyz, rgb);
  const float x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Triple FromOpponent(const Triple& opponent) {
  const float y = (opponent[0] + 16) / 116;
  const float x = y + opponent[1] / 500, z = y - opponent[2] / 200;
  return Times(kFromXyz, {x * kWhite[0], y * kWhite[1], z * kWhite[2]});
}

// L*a*b* with a and b reduced in the dark (the Hunt effect).
Triple ToHuntLab(const Triple& rgb) {
  Triple f = Times(kToXyz, rgb);
  for (size_t i = 0; i < 3; ++i) {
    constexpr float kDelta = 6.0f / 29;
    const float ratio = f[i] / kWhite[i];
    f[i] = ratio > kDelta * kDelta * kDelta ? std::cbrt(ratio) : ratio / (3 * kDelta * kDelta) + 4.0f / 29;
  }
  const float lightness = 116 * f[1] - 16;
  return {lightness, 0.01f * lightness * (500 * (f[0] - f[1])), 0.01f * lightness * (200 * (f[1] - f[2]))};
}

// HyAB, a distance for large differences (Abasi, Tehran and Fairchild 2020).
float HyAb(const Triple& a, const Triple& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

// Linear values as the screen shows them, from 0 to 1.
class Tone {
 public:
  Tone() = default;
  explicit Tone(double exposure) : is_hdr_(true), scale_(static_cast<float>(std::exp2(exposure))) {}
  float operator()(float value) const {
    const float positive = std::max(0.0f, value);  // 0 if it is NaN
    return is_hdr_ ? AcesCurve::Map(scale_ * positive) : std::min(positive, 1.0f);
  }

 private:
  bool is_hdr_ = false;
  float scale_ = 1;
};

// Where the colours of a picture are.
class ColorSource {
 public:
  explicit ColorSource(const LoadedPicture& picture) : picture_(picture) {
    constexpr const char* kNames[] = {"R", "G", "B"};
    for (size_t i = 0; i < 3; ++i) {
      const auto found = std::ranges::find(picture.channels, kNames[i]);
      TESSERA_CHECK(found != picture.channels.end());
      places_[i] = static_cast<size_t>(found - picture.channels.begin());
    }
  }
  // Pixels outside are those of the border.
  Triple At(int x, int y) const {
    const int64_t column = std::clamp(x, 0, picture_.bounds.width() - 1);
    const int64_t row = std::clamp(y, 0, picture_.bounds.height() - 1);
    const float* const pixel =
        &picture_
             .values[static_cast<size_t>(row * picture_.bounds.width() + column) * picture_.channels.size()];
    return {pixel[places_[0]], pixel[places_[1]], pixel[places_[2]]};
  }

 private:
  const LoadedPicture& picture_;
  std::array<size_t, 3> places_{};
};

// What FLIP compares of the pixels of a tile.
struct Seen {
  Grid lab[3];
  Grid edges, points;  // strength of the features
};

Grid Strength(const Grid& along_x, const Grid& along_y) {
  Grid strength(along_x.width, along_x.height);
  for (size_t i = 0; i < strength.values.size(); ++i) {
    const float x = along_x.values[i], y = along_y.values[i];
    strength.values[i] = std::sqrt(x * x + y * y);
  }
  return strength;
}

class TileObserver {
 public:
  TileObserver(const FlipFilters& filters, const PixelBounds& tile) : filters_(filters), tile_(tile) {}

  Seen Observe(const ColorSource& source, const Tone& tone) const {
    const int width = tile_.width() + 2 * kFlipRadius, height = tile_.height() + 2 * kFlipRadius;
    Grid opponent[3] = {{width, height}, {width, height}, {width, height}};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Triple rgb = source.At(tile_.x0 + x - kFlipRadius, tile_.y0 + y - kFlipRadius);
        const Triple seen = ToOpponent({tone(rgb[0]), tone(rgb[1]), tone(rgb[2])});
        for (size_t c = 0; c < 3; ++c) opponent[c].Row(y)[x] = seen[c];
      }
    }
    Seen seen = {{Blurred(opponent[0], filters_.achromatic), Blurred(opponent[1], filters_.red_green),
                  BlurredTwice(opponent[2])},
                 {0, 0},
                 {0, 0}};
    for (size_t i = 0; i < seen.lab[0].values.size(); ++i) {
      Triple rgb = FromOpponent({seen.lab[0].values[i], seen.lab[1].values[i], seen.lab[2].values[i]});
      for (float& value : rgb) value = std::clamp(value, 0.0f, 1.0f);
      const Triple lab = ToHuntLab(rgb);
      for (size_t c = 0; c < 3; ++c) seen.lab[c].values[i] = lab[c];
    }
    for (float& value : opponent[0].values) value = (value + 16) / 116;
    const Grid smooth_rows = FilterRows(opponent[0], filters_.smooth);
    seen.edges = Features(opponent[0], smooth_rows, filters_.edge);
    seen.points = Features(opponent[0], smooth_rows, filters_.point);
    return seen;
  }

 private:
  static Grid Blurred(const Grid& grid, const Kernel& kernel) {
    return FilterColumns(FilterRows(grid, kernel), kernel);
  }
  Grid BlurredTwice(const Grid& grid) const {
    Grid sum = Blurred(grid, filters_.blue_yellow[0]);
    const Grid second = Blurred(grid, filters_.blue_yellow[1]);
    for (size_t i = 0; i < sum.values.size(); ++i) {
      sum.values[i] =
          filters_.blue_yellow_share[0] * sum.values[i] + filters_.blue_yellow_share[1] * second.values[i];
    }
    return sum;
  }
  Grid Features(const Grid& grid, const Grid& smooth_rows, const Kernel& detector) const {
    return Strength(FilterColumns(FilterRows(grid, detector), filters_.smooth),
                    FilterColumns(smooth_rows, detector));
  }

  const FlipFilters& filters_;
  const PixelBounds tile_;
};

// The error of the difference of two colours.
class ColorError {
 public:
  ColorError() : largest_(std::pow(HyAb(ToHuntLab({0, 1, 0}), ToHuntLab({0, 0, 1})), kColorExponent)) {}
  float operator()(const Triple& a, const Triple& b) const {
    const float difference = std::pow(HyAb(a, b), kColorExponent);
    const float knee = kKnee * largest_;
    if (difference < knee) return kKneeError / knee * difference;
    return kKneeError + (difference - knee) / (largest_ - knee) * (1 - kKneeError);
  }

 private:
  const float largest_;  // of the colours that a screen shows: green and blue
};

class FlipComparison {
 public:
  FlipComparison(const LoadedPicture& test, const LoadedPicture& reference, std::vector<Tone> tones)
      : test_(test), reference_(reference), tones_(std::move(tones)) {
    result_.width = test.bounds.width();
    result_.height = test.bounds.height();
    result_.errors.resize(static_cast<size_t>(test.bounds.area()));
    columns_ = (result_.width + kTileWidth - 1) / kTileWidth;
    rows_ = (result_.height + kTileHeight - 1) / kTileHeight;
  }

  Result<FlipErrors> Run(int threads, const std::stop_token& stop) {
    const size_t tiles = static_cast<size_t>(columns_) * static_cast<size_t>(rows_);
    auto done = ForEachItem(tiles, threads, stop, [this](size_t tile) {
      for (const Tone& tone : tones_) CompareTile(Bounds(tile), tone);
    });
    if (!done) return done.error();
    double sum = 0;
    for (const float error : result_.errors) sum += error;
    result_.mean = sum / static_cast<double>(result_.errors.size());
    return std::move(result_);
  }

 private:
  PixelBounds Bounds(size_t tile) const {
    const int x = static_cast<int>(tile % static_cast<size_t>(columns_)) * kTileWidth;
    const int y = static_cast<int>(tile / static_cast<size_t>(columns_)) * kTileHeight;
    return {x, y, std::min(x + kTileWidth, result_.width), std::min(y + kTileHeight, result_.height)};
  }

  // Raises the errors of the tile to those seen with this tone.
  void CompareTile(const PixelBounds& tile, const Tone& tone) {
    const TileObserver observer(filters_, tile);
    const Seen a = observer.Observe(test_, tone);
    const Seen b = observer.Observe(reference_, tone);
    for (int y = 0; y < tile.height(); ++y) {
      float* const errors = &result_.errors[static_cast<size_t>(int64_t{tile.y0 + y} * result_.width) +
                                            static_cast<size_t>(tile.x0)];
      for (int x = 0; x < tile.width(); ++x) errors[x] = std::max(errors[x], ErrorAt(a, b, x, y));
    }
  }

  float ErrorAt(const Seen& a, const Seen& b, int x, int y) const {
    const auto lab = [&](const Seen& seen) -> Triple {
      return {seen.lab[0].Row(y)[x], seen.lab[1].Row(y)[x], seen.lab[2].Row(y)[x]};
    };
    const float color = color_error_(lab(a), lab(b));
    const float feature = std::max(std::abs(a.edges.Row(y)[x] - b.edges.Row(y)[x]),
                                   std::abs(a.points.Row(y)[x] - b.points.Row(y)[x]));
    const float feature_error = std::pow(feature / std::sqrt(2.0f), kFeatureExponent);
    return std::clamp(std::pow(color, 1 - feature_error), 0.0f, 1.0f);
  }

  const FlipFilters filters_;
  const ColorError color_error_;
  const ColorSource test_, reference_;
  const std::vector<Tone> tones_;
  FlipErrors result_;
  int columns_ = 0, rows_ = 0;  // of tiles
};

std::vector<float> Luminances(const LoadedPicture& picture) {
  const ColorSource source(picture);
  std::vector<float> luminances;
  luminances.reserve(static_cast<size_t>(picture.bounds.area()));
  for (int y = 0; y < picture.bounds.height(); ++y) {
    for (int x = 0; x < picture.bounds.width(); ++x) {
      const Triple rgb = source.At(x, y);
      luminances.push_back(0.2126f * std::max(0.0f, rgb[0]) + 0.7152f * std::max(0.0f, rgb[1]) +
                           0.0722f * std::max(0.0f, rgb[2]));
    }
  }
  return luminances;
}

}  // namespace

bool HasColors(const LoadedPicture& picture) {
  return std::ranges::count_if(picture.channels, IsColorChannel) == 3;
}

Result<FlipErrors> LdrFlip(const LoadedPicture& test, const LoadedPicture& reference, int threads,
                           const std::stop_token& stop) {
  return FlipComparison(test, reference, {Tone()}).Run(threads, stop);
}

Result<FlipErrors> HdrFlip(const LoadedPicture& test, const LoadedPicture& reference, int threads,
                           const std::stop_token& stop) {
  const ExposureRange range = ExposuresFor(Luminances(reference));
  const double step = (range.stop - range.start) / std::max(range.count - 1, 1);
  std::vector<Tone> tones;
  tones.reserve(static_cast<size_t>(range.count));
  for (int i = 0; i < range.count; ++i) tones.emplace_back(range.start + i * step);
  auto errors = FlipComparison(test, reference, std::move(tones)).Run(threads, stop);
  if (errors) errors->exposures = range;
  return errors;
}

}  // namespace tessera
