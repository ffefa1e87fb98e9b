// Builds the levels of a MipMap row by row, so that no more than a quarter of the image is held as floats.
#include <immintrin.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <functional>

#include "renderer/image/color_encoding.h"
#include "renderer/texture/mip_map.h"

namespace tessera {
namespace {

constexpr float kHalfMax = 65504;
constexpr float kFloatTexelMax = 1e30f;  // sums of a few stay finite

// Linear values to the nearest 8-bit code.
class Encoder {
 public:
  explicit Encoder(const ColorEncoding& encoding) {
    for (int code = 0; code < 255; ++code) {
      threshold_[code] = encoding.ToLinear((static_cast<float>(code) + 0.5f) / 255.0f);
    }
    int code = 0;
    for (int i = 0; i < kGuesses; ++i) {
      while (code < 255 && static_cast<float>(i) / kGuesses >= threshold_[code]) ++code;
      guess_[i] = static_cast<uint8_t>(code);
    }
  }

  uint8_t operator()(float value) const {
    if (!(value > 0)) return 0;
    if (value >= 1) return 255;
    int code = guess_[static_cast<int>(value * kGuesses)];
    while (code < 255 && value >= threshold_[code]) ++code;
    return static_cast<uint8_t>(code);
  }

 private:
  static constexpr int kGuesses = 4096;
  std::array<float, 255> threshold_;  // [code]: the least value that is nearer to code + 1
  std::array<uint8_t, kGuesses> guess_;
};

float Sinc(float x) {
  return 1 - x * x == 1 ? 1 : std::sin(kPi * x) / (kPi * x);
}
float WindowedSinc(float x, float radius) {
  return std::abs(x) > radius ? 0 : Sinc(x) * Sinc(x / radius);
}

// The weights of the four neighbours that make one resampled value (Lanczos filter of radius 2).
struct ResampleWeight {
  int first = 0;
  std::array<float, 4> weight{};
};

std::vector<ResampleWeight> ResampleWeights(int old_size, int new_size) {
  constexpr float kRadius = 2;
  std::vector<ResampleWeight> weights(new_size);
  for (int i = 0; i < new_size; ++i) {
    const float center =
        (static_cast<float>(i) + 0.5f) * static_cast<float>(old_size) / static_cast<float>(new_size);
    ResampleWeight& w = weights[i];
    w.first = static_cast<int>(std::floor(center - kRadius + 0.5f));
    float sum = 0;
    for (int j = 0; j < 4; ++j) {
      w.weight[j] = WindowedSinc(static_cast<float>(w.first + j) + 0.5f - center, kRadius);
      sum += w.weight[j];
    }
    for (float& v : w.weight) v /= sum;
  }
  return weights;
}

// The chosen channels of an image, as finite linear floats.
class Source {
 public:
  Source(const Image& image, std::vector<int> channels, bool mean)
      : image_(image), channels_(std::move(channels)), mean_(mean), decoded_(DecodingTable(image.encoding)) {}

  int width() const { return image_.width; }
  int height() const { return image_.height; }
  int channels() const { return mean_ ? 1 : static_cast<int>(channels_.size()); }

  void Read(int x, int y, float* values) const {
    float sum = 0;
    for (size_t i = 0; i < channels_.size(); ++i) {
      const float value = Value(x, y, channels_[i]);
      if (!mean_) values[i] = value;
      sum += value;
    }
    if (mean_) values[0] = sum / static_cast<float>(channels_.size());
  }

 private:
  float Value(int x, int y, int channel) const {
    if (image_.format == PixelFormat::kUint8) {
      return decoded_[image_.bytes[(static_cast<size_t>(y) * image_.width + x) * image_.channels + channel]];
    }
    const float value = image_.Get(x, y, channel);
    return std::isnan(value) ? 0 : std::clamp(value, -kFloatTexelMax, kFloatTexelMax);
  }

  const Image& image_;
  std::vector<int> channels_;
  bool mean_;
  std::array<float, 256> decoded_;
};

// Returns the rows of an image resampled to larger sides, from top to bottom.
class Resampler {
 public:
  Resampler(const Source& source, int width, int height, WrapMode wrap)
      : source_(source),
        wrap_(wrap),
        width_(width),
        x_weights_(ResampleWeights(source.width(), width)),
        y_weights_(ResampleWeights(source.height(), height)),
        padded_((source.width() + 2 * kPadding) * source.channels()) {
    for (Row& row : rows_) row.values.resize(static_cast<size_t>(width) * source.channels());
  }

  void Read(int y, float* out) {
    const ResampleWeight& w = y_weights_[y];
    std::array<const float*, 4> rows;
    for (int j = 0; j < 4; ++j) rows[j] = WidenedRow(w.first + j).data();
    const size_t count = static_cast<size_t>(width_) * source_.channels();
    for (size_t i = 0; i < count; ++i) {
      const float sum = w.weight[0] * rows[0][i] + w.weight[1] * rows[1][i] + w.weight[2] * rows[2][i] +
                        w.weight[3] * rows[3][i];
      out[i] = std::max(0.0f, sum);  // the negative lobes of the filter must not give negative light
    }
  }

 private:
  static constexpr int kPadding = 3;  // texels beyond the borders that the filter can reach
  struct Row {
    int y = -1000;
    std::vector<float> values;
  };

  // A row of the source (perhaps beyond its border), resampled in x. The last four are kept.
  const std::vector<float>& WidenedRow(int y) {
    Row& row = rows_[static_cast<unsigned>(y) & 3];
    if (row.y == y) return row.values;
    row.y = y;
    const int channels = source_.channels();
    for (int i = -kPadding; i < source_.width() + kPadding; ++i) {
      float* to = &padded_[static_cast<size_t>(i + kPadding) * channels];
      int sx = i, sy = y;
      if (Remap(sx, sy, source_.width(), source_.height(), wrap_))
        source_.Read(sx, sy, to);
      else
        std::fill(to, to + channels, 0.0f);
    }
    for (int x = 0; x < width_; ++x) {
      const ResampleWeight& w = x_weights_[x];
      const float* from = &padded_[static_cast<size_t>(w.first + kPadding) * channels];
      for (int c = 0; c < channels; ++c) {
        row.values[static_cast<size_t>(x) * channels + c] =
            w.weight[0] * from[c] + w.weight[1] * from[channels + c] + w.weight[2] * from[2 * channels + c] +
            w.weight[3] * from[3 * channels + c];
      }
    }
    return row.values;
  }

  const Source& source_;
  WrapMode wrap_;
  int width_;
  std::vector<ResampleWeight> x_weights_, y_weights_;
  std::vector<float> padded_;
  std::array<Row, 4> rows_;
};

}  // namespace

class MipMapMaker {
 public:
  MipMapMaker(const Source& source, PixelFormat format, const Image& image, WrapMode wrap)
      : source_(source), encoder_(image.encoding) {
    map_.format_ = format;
    map_.chromaticities_ = image.chromaticities;
    map_.wrap_ = wrap;
    map_.channels_ = source.channels();
    map_.decoded_ = DecodingTable(image.encoding);
    AddLevels(static_cast<int>(std::bit_ceil(static_cast<unsigned>(source.width()))),
              static_cast<int>(std::bit_ceil(static_cast<unsigned>(source.height()))));
  }

  MipMap Make() {
    const bool as_is = source_.width() == map_.width() && source_.height() == map_.height();
    std::vector<float> level;
    if (as_is) {
      level = FillLevel(0, [this](int y, float* row) {
        for (int x = 0; x < source_.width(); ++x)
          source_.Read(x, y, row + static_cast<size_t>(x) * map_.channels_);
      });
    } else {
      Resampler resampler(source_, map_.width(), map_.height(), map_.wrap_);
      level = FillLevel(0, [&resampler](int y, float* row) { resampler.Read(y, row); });
    }
    for (int i = 1; i < map_.levels(); ++i) {
      const size_t row_size = static_cast<size_t>(map_.levels_[i].width) * map_.channels_;
      level = FillLevel(i, [&level, row_size](int y, float* row) {
        std::copy_n(&level[static_cast<size_t>(y) * row_size], row_size, row);
      });
    }
    return std::move(map_);
  }

 private:
  using RowReader = std::function<void(int y, float* row)>;

  size_t ValueSize() const {
    return map_.format_ == PixelFormat::kUint8 ? 1 : map_.format_ == PixelFormat::kHalf ? 2 : 4;
  }

  void AddLevels(int width, int height) {
    constexpr size_t kLoadSize = 16;  // bytes
    size_t offset = 0;
    while (true) {
      map_.levels_.push_back({offset, width, height});
      offset += static_cast<size_t>(width) * height * map_.channels_ * ValueSize();
      if (width == 1 && height == 1) break;
      width = std::max(1, width / 2);
      height = std::max(1, height / 2);
    }
    map_.texels_.resize(offset + kLoadSize);
  }

  // Stores a level, whose rows `read` returns, and returns the next one: each texel is the mean of up to
  // four.
  std::vector<float> FillLevel(int i, const RowReader& read) {
    const MipMap::Level& level = map_.levels_[i];
    const int channels = map_.channels_;
    const int next_width = std::max(1, level.width / 2), next_height = std::max(1, level.height / 2);
    std::vector<float> next(static_cast<size_t>(next_width) * next_height * channels);
    std::vector<float> upper(static_cast<size_t>(level.width) * channels), lower(upper.size());
    for (int y = 0; y < next_height; ++y) {
      read(2 * y, upper.data());
      Store(level, 2 * y, upper);
      if (level.height > 1) {
        read(2 * y + 1, lower.data());
        Store(level, 2 * y + 1, lower);
      } else {
        lower = upper;
      }
      const int right = level.width > 1 ? channels : 0;
      for (int x = 0; x < next_width; ++x) {
        for (int c = 0; c < channels; ++c) {
          const size_t from = static_cast<size_t>(2 * x) * channels + c;
          next[(static_cast<size_t>(y) * next_width + x) * channels + c] =
              (upper[from] + upper[from + right] + lower[from] + lower[from + right]) / 4;
        }
      }
    }
    return next;
  }

  void Store(const MipMap::Level& level, int y, const std::vector<float>& row) {
    uint8_t* to = &map_.texels_[level.offset + static_cast<size_t>(y) * row.size() * ValueSize()];
    for (size_t i = 0; i < row.size(); ++i) {
      if (map_.format_ == PixelFormat::kUint8) {
        to[i] = encoder_(row[i]);
      } else if (map_.format_ == PixelFormat::kHalf) {
        const uint16_t half = _cvtss_sh(std::clamp(row[i], -kHalfMax, kHalfMax), _MM_FROUND_TO_NEAREST_INT);
        std::memcpy(to + 2 * i, &half, sizeof half);
      } else {
        std::memcpy(to + 4 * i, &row[i], sizeof(float));
      }
    }
  }

  const Source& source_;
  Encoder encoder_;
  MipMap map_;
};

MipMap MipMap::Grey(const Image& image, int channel, WrapMode wrap) {
  const Source source(image, {channel}, false);
  return MipMapMaker(source, image.format, image, wrap).Make();
}

MipMap MipMap::Color(const Image& image, std::array<int, 3> channels, WrapMode wrap) {
  const Source source(image, {channels[0], channels[1], channels[2]}, false);
  return MipMapMaker(source, image.format, image, wrap).Make();
}

MipMap MipMap::GreyOfColor(const Image& image, std::array<int, 3> channels, WrapMode wrap) {
  const Source source(image, {channels[0], channels[1], channels[2]}, true);
  const PixelFormat format = image.format == PixelFormat::kUint8 ? PixelFormat::kHalf : image.format;
  return MipMapMaker(source, format, image, wrap).Make();
}

}  // namespace tessera
