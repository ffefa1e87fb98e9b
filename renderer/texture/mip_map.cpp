#include "renderer/texture/mip_map.h"

#include <immintrin.h>

#include <cmath>
#include <cstring>

namespace tessera {
namespace {

constexpr float kTexelIndexMax = 1 << 28;  // beyond this, floats no longer resolve texels
constexpr float kWidthMin = 1e-8f;         // of a footprint; smaller ones all use the finest level
constexpr int kEwaWeightCount = 128;

int FloorToInt(float v) {
  const float f = std::floor(v);
  return std::abs(f) < kTexelIndexMax ? static_cast<int>(f) : 0;  // NaN: 0
}

// A Gaussian exp(-2 r^2), shifted to reach 0 at r = 1, by r^2.
std::array<float, kEwaWeightCount> MakeEwaWeights() {
  std::array<float, kEwaWeightCount> weights;
  for (int i = 0; i < kEwaWeightCount; ++i) {
    const float r2 = static_cast<float>(i) / (kEwaWeightCount - 1);
    weights[i] = std::exp(-2 * r2) - std::exp(-2.0f);
  }
  return weights;
}
const std::array<float, kEwaWeightCount> kEwaWeights = MakeEwaWeights();

bool IsFinite(Vec2 v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}
float LengthSquared(Vec2 v) {
  return v.x * v.x + v.y * v.y;
}

float Mix(float t, float a, float b) {
  return (1 - t) * a + t * b;
}
Float4 Mix(float t, Float4 a, Float4 b) {
  return (1 - t) * a + t * b;
}

}  // namespace

// Reads a MipMap whose format and number of channels are known at compile time.
template <PixelFormat kFormat, int kChannels>
class MipMapReader {
 public:
  using Value = std::conditional_t<kChannels == 1, float, Float4>;

  explicit MipMapReader(const MipMap& map) : map_(map), top_(map.levels() - 1) {}

  Value LookUp(Point2 st, Vec2 dst0, Vec2 dst1, const ImageFilterSettings& settings) const {
    st = Wrapped(st);
    if (!IsFinite(dst0) || !IsFinite(dst1)) return Load(top_, 0, 0);
    if (settings.filter == ImageFilter::kEwa) return Ewa(st, dst0, dst1, settings.anisotropy_max);
    const float width = 2 * std::max(std::max(std::abs(dst0.x), std::abs(dst0.y)),
                                     std::max(std::abs(dst1.x), std::abs(dst1.y)));
    if (width >= 1) return Load(top_, 0, 0);
    // Level 0 needs no logarithm: it is used while the footprint is smaller than two of its texels.
    const float level = width * std::max(map_.width(), map_.height()) < 2 ? 0 : top_ + std::log2(width);
    const int fine = std::min(std::max(0, FloorToInt(level)), top_);
    switch (settings.filter) {
      case ImageFilter::kPoint: return Nearest(fine, st);
      case ImageFilter::kBilinear: return Bilinear(fine, st);
      default: break;
    }
    if (fine == 0 || fine == top_) return Bilinear(fine, st);
    return Mix(level - static_cast<float>(fine), Bilinear(fine, st), Bilinear(fine + 1, st));
  }

 private:
  // The lookup of a repeating image is periodic, so st can be made small, where floats are precise.
  Point2 Wrapped(Point2 st) const {
    if (!IsFinite(st)) return {0, 0};
    if (map_.wrap_ == WrapMode::kRepeat) return {st.x - std::floor(st.x), st.y - std::floor(st.y)};
    return st;
  }

  Value Load(int level, int x, int y) const {
    const MipMap::Level& l = map_.levels_[level];
    constexpr size_t kValueSize = kFormat == PixelFormat::kUint8 ? 1 : kFormat == PixelFormat::kHalf ? 2 : 4;
    const size_t texel = static_cast<size_t>(y) * l.width + x;
    return Decode(&map_.texels_[l.offset + texel * (kChannels * kValueSize)]);
  }

  Value Decode(const uint8_t* p) const {
    if constexpr (kFormat == PixelFormat::kUint8 && kChannels == 1) {
      return map_.decoded_[p[0]];
    } else if constexpr (kFormat == PixelFormat::kUint8) {
      return {map_.decoded_[p[0]], map_.decoded_[p[1]], map_.decoded_[p[2]], 0};
    } else if constexpr (kFormat == PixelFormat::kHalf && kChannels == 1) {
      uint16_t half;
      std::memcpy(&half, p, sizeof half);
      return _cvtsh_ss(half);
    } else if constexpr (kFormat == PixelFormat::kHalf) {
      return Float4(_mm_cvtph_ps(_mm_loadu_si64(p)));
    } else if constexpr (kChannels == 1) {
      float value;
      std::memcpy(&value, p, sizeof value);
      return value;
    } else {
      return Float4(_mm_loadu_ps(reinterpret_cast<const float*>(p)));
    }
  }

  Value LoadWrapped(int level, int x, int y) const {
    const MipMap::Level& l = map_.levels_[level];
    return Remap(x, y, l.width, l.height, map_.wrap_) ? Load(level, x, y) : Value{};
  }

  Value Nearest(int level, Point2 st) const {
    const MipMap::Level& l = map_.levels_[level];
    return LoadWrapped(level, FloorToInt(st.x * l.width), FloorToInt(st.y * l.height));
  }

  Value Bilinear(int level, Point2 st) const {
    const MipMap::Level& l = map_.levels_[level];
    const float x = st.x * l.width - 0.5f, y = st.y * l.height - 0.5f;
    const int xi = FloorToInt(x), yi = FloorToInt(y);
    const float dx = std::min(x - xi, 1.0f), dy = std::min(y - yi, 1.0f);
    if (xi >= 0 && yi >= 0 && xi + 1 < l.width && yi + 1 < l.height) {
      return Mix(dy, Mix(dx, Load(level, xi, yi), Load(level, xi + 1, yi)),
                 Mix(dx, Load(level, xi, yi + 1), Load(level, xi + 1, yi + 1)));
    }
    return Mix(dy, Mix(dx, LoadWrapped(level, xi, yi), LoadWrapped(level, xi + 1, yi)),
               Mix(dx, LoadWrapped(level, xi, yi + 1), LoadWrapped(level, xi + 1, yi + 1)));
  }

  Value Ewa(Point2 st, Vec2 dst0, Vec2 dst1, float anisotropy_max) const {
    if (LengthSquared(dst0) < LengthSquared(dst1)) std::swap(dst0, dst1);
    const float longer = std::sqrt(LengthSquared(dst0));
    float shorter = std::sqrt(LengthSquared(dst1));
    if (!(shorter > 0)) return Bilinear(0, st);
    if (shorter * anisotropy_max < longer) {
      const float scale = longer / (shorter * anisotropy_max);
      dst1 = dst1 * scale;
      shorter *= scale;
    }
    const float level = std::max(0.0f, top_ + std::log2(std::max(shorter, kWidthMin)));
    if (!(level < top_)) return Load(top_, 0, 0);
    const int fine = FloorToInt(level);
    return Mix(level - static_cast<float>(fine), EwaAt(fine, st, dst0, dst1),
               EwaAt(fine + 1, st, dst0, dst1));
  }

  // The mean of the texels of one level under the ellipse of axes dst0 and dst1 (Heckbert 1989,
  // section 3.5.8).
  Value EwaAt(int level, Point2 st, Vec2 dst0, Vec2 dst1) const {
    if (level >= top_) return Load(top_, 0, 0);
    const MipMap::Level& l = map_.levels_[level];
    const float w = static_cast<float>(l.width), h = static_cast<float>(l.height);
    const float s = st.x * w - 0.5f, t = st.y * h - 0.5f;
    const Vec2 d0{dst0.x * w, dst0.y * h}, d1{dst1.x * w, dst1.y * h};
    // a s^2 + b s t + c t^2 < 1 inside; the 1 widens it to at least a texel.
    float a = d0.y * d0.y + d1.y * d1.y + 1;
    float b = -2 * (d0.x * d0.y + d1.x * d1.y);
    float c = d0.x * d0.x + d1.x * d1.x + 1;
    const float inverse = 1 / (a * c - b * b * 0.25f);
    a *= inverse;
    b *= inverse;
    c *= inverse;
    const float determinant = 4 * a * c - b * b;
    const float reach_s = 2 / determinant * SafeSqrt(determinant * c);
    const float reach_t = 2 / determinant * SafeSqrt(a * determinant);
    // A wider reach than one period or the border adds nothing new.
    if (!(reach_s < 2 * w + 4) || !(reach_t < 2 * h + 4)) return Bilinear(level, st);
    return EwaSum(level, {s, t}, {reach_s, reach_t}, a, b, c);
  }

  Value EwaSum(int level, Point2 center, Vec2 reach, float a, float b, float c) const {
    const int s_min = FloorToInt(center.x - reach.x) + 1, s_max = FloorToInt(center.x + reach.x);
    const int t_min = FloorToInt(center.y - reach.y) + 1, t_max = FloorToInt(center.y + reach.y);
    Value sum{};
    float weight_sum = 0;
    for (int y = t_min; y <= t_max; ++y) {
      const float dt = static_cast<float>(y) - center.y;
      for (int x = s_min; x <= s_max; ++x) {
        const float ds = static_cast<float>(x) - center.x;
        const float r2 = a * ds * ds + b * ds * dt + c * dt * dt;
        if (!(r2 < 1)) continue;
        const int index =
            std::min(static_cast<int>(std::max(r2, 0.0f) * kEwaWeightCount), kEwaWeightCount - 1);
        const float weight = kEwaWeights[index];
        sum += weight * LoadWrapped(level, x, y);
        weight_sum += weight;
      }
    }
    const Point2 st{(center.x + 0.5f) / map_.levels_[level].width,
                    (center.y + 0.5f) / map_.levels_[level].height};
    return weight_sum > 0 ? sum / weight_sum : Bilinear(level, st);
  }

  const MipMap& map_;
  int top_;
};

float MipMap::LookUpGrey(Point2 st, Vec2 dst0, Vec2 dst1, const ImageFilterSettings& settings) const {
  switch (format_) {
    case PixelFormat::kUint8:
      return MipMapReader<PixelFormat::kUint8, 1>(*this).LookUp(st, dst0, dst1, settings);
    case PixelFormat::kHalf:
      return MipMapReader<PixelFormat::kHalf, 1>(*this).LookUp(st, dst0, dst1, settings);
    case PixelFormat::kFloat: break;
  }
  return MipMapReader<PixelFormat::kFloat, 1>(*this).LookUp(st, dst0, dst1, settings);
}

Float4 MipMap::LookUpColor(Point2 st, Vec2 dst0, Vec2 dst1, const ImageFilterSettings& settings) const {
  switch (format_) {
    case PixelFormat::kUint8:
      return MipMapReader<PixelFormat::kUint8, 3>(*this).LookUp(st, dst0, dst1, settings);
    case PixelFormat::kHalf:
      return MipMapReader<PixelFormat::kHalf, 3>(*this).LookUp(st, dst0, dst1, settings);
    case PixelFormat::kFloat: break;
  }
  return MipMapReader<PixelFormat::kFloat, 3>(*this).LookUp(st, dst0, dst1, settings);
}

float MipMap::Texel(int level, int x, int y, int channel) const {
  const Level& l = levels_[level];
  const size_t index = (static_cast<size_t>(y) * l.width + x) * channels_ + channel;
  switch (format_) {
    case PixelFormat::kUint8: return decoded_[texels_[l.offset + index]];
    case PixelFormat::kHalf: {
      uint16_t half;
      std::memcpy(&half, &texels_[l.offset + index * 2], sizeof half);
      return _cvtsh_ss(half);
    }
    case PixelFormat::kFloat: break;
  }
  float value;
  std::memcpy(&value, &texels_[l.offset + index * 4], sizeof value);
  return value;
}

}  // namespace tessera
