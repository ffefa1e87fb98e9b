#include "renderer/filter/tabulated_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "renderer/util/hash.h"

namespace tessera {
namespace {

constexpr int kIntervals = 512;    // per axis: far below what a pixel's samples can resolve
constexpr int kGuideParts = 1024;  // twice the intervals; a power of two, so that the product with u is exact

// The value at the radius is subtracted, so that the filter ends at 0.
float Gaussian(float x, float radius, float sigma) {
  const float k = -1 / (2 * Sqr(sigma));
  return std::max(0.0f, std::exp(k * x * x) - std::exp(k * radius * radius));
}

// Mitchell and Netravali 1988, scaled so that its 2 is the radius.
float Mitchell(float x, float radius, float b, float c) {
  const float t = std::abs(2 * x / radius);
  if (t <= 1) return ((12 - 9 * b - 6 * c) * t * t * t + (-18 + 12 * b + 6 * c) * t * t + (6 - 2 * b)) / 6;
  if (t <= 2)
    return ((-b - 6 * c) * t * t * t + (6 * b + 30 * c) * t * t + (-12 * b - 48 * c) * t + (8 * b + 24 * c)) /
           6;
  return 0;
}

float Sinc(float x) {
  if (1 - x * x == 1) return 1;
  return std::sin(kPi * x) / (kPi * x);
}

// Windowed by `tau` lobes of Lanczos' window.
float WindowedSinc(float x, float radius, float tau) {
  return std::abs(x) > radius ? 0 : Sinc(x) * Sinc(x / tau);
}

// Both axes by the same function of a coordinate and the axis' radius.
template <typename F>
TabulatedFilter Tabulate(Vec2 radius, const F& f) {
  const auto axis = [&f](float r) { return FilterAxis(r, [&f, r](float x) { return f(x, r); }); };
  return {axis(radius.x), axis(radius.y)};
}

}  // namespace

FilterAxis::FilterAxis(float radius, const std::function<float(float x)>& f) : radius_(radius) {
  value_.resize(kIntervals + 1);
  cdf_.resize(kIntervals + 1);
  for (int i = 0; i <= kIntervals; ++i) value_[i] = f(radius * (2.0f * i / kIntervals - 1));
  for (int i = 1; i <= kIntervals; ++i) {
    cdf_[i] = cdf_[i - 1] + (std::abs(value_[i - 1]) + std::abs(value_[i])) / 2;
  }
  for (float& c : cdf_) c /= cdf_[kIntervals];
  guide_.resize(kGuideParts);
  for (int part = 0; part < kGuideParts; ++part) {
    const auto above = std::upper_bound(cdf_.begin(), cdf_.end(), static_cast<float>(part) / kGuideParts);
    guide_[part] = static_cast<uint16_t>(std::clamp<ptrdiff_t>(above - cdf_.begin() - 1, 0, kIntervals - 1));
  }
}

// The last interval that starts at or before u: a step or two from where the guide points (Chen and Asau
// 1974). The first without a branch, which could not be predicted.
int FilterAxis::IntervalOf(float u) const {
  int i = guide_[static_cast<int>(u * kGuideParts)];
  i += static_cast<int>((i < kIntervals - 1) & (cdf_[i + 1] <= u));
  while (i < kIntervals - 1 && cdf_[i + 1] <= u) ++i;
  return i;
}

float FilterAxis::Sample(float u, float* sign) const {
  const int i = IntervalOf(u);
  const float width = cdf_[i + 1] - cdf_[i];
  const float a = std::abs(value_[i]), b = std::abs(value_[i + 1]);
  const float v = width > 0 ? std::clamp((u - cdf_[i]) / width, 0.0f, kOneMinusEpsilon) : 0.5f;
  // |f| is the line from a to b within the interval
  const float root = std::sqrt(Lerp(v, a * a, b * b));
  const float t = a + root > 0 ? std::min(v * (a + b) / (a + root), 1.0f) : v;
  *sign = Lerp(t, value_[i], value_[i + 1]) < 0 ? -1.0f : 1.0f;
  return radius_ * (2 * (i + t) / kIntervals - 1);
}

float FilterAxis::Evaluate(float x) const {
  const float place = (x / radius_ + 1) / 2 * kIntervals;
  if (!(place >= 0 && place <= kIntervals)) return 0;
  const int i = std::min(static_cast<int>(place), kIntervals - 1);
  return Lerp(place - i, value_[i], value_[i + 1]);
}

TabulatedFilter TabulatedFilter::ReadGaussian(ParameterReader& reader) {
  const Vec2 radius = ReadRadius(reader, 1.5f);
  const float sigma = reader.Float("sigma", 0.5f);
  if (!(sigma > 0)) reader.FailAt("sigma", "sigma must be above 0");
  return Tabulate(radius, [sigma](float x, float r) { return Gaussian(x, r, sigma); });
}

TabulatedFilter TabulatedFilter::ReadMitchell(ParameterReader& reader) {
  const Vec2 radius = ReadRadius(reader, 2);
  const float b = reader.Float("B", 1.0f / 3);
  const float c = reader.Float("C", 1.0f / 3);
  return Tabulate(radius, [b, c](float x, float r) { return Mitchell(x, r, b, c); });
}

TabulatedFilter TabulatedFilter::ReadSinc(ParameterReader& reader) {
  const Vec2 radius = ReadRadius(reader, 4);
  const float tau = reader.Float("tau", 3);
  if (!(tau > 0)) reader.FailAt("tau", "tau must be above 0");
  return Tabulate(radius, [tau](float x, float r) { return WindowedSinc(x, r, tau); });
}

FilterSample TabulatedFilter::Sample(Point2 u) const {
  FilterSample sample;
  float sign_x, sign_y;
  sample.offset.x = x_.Sample(u.x, &sign_x);
  sample.offset.y = y_.Sample(u.y, &sign_y);
  sample.weight = sign_x * sign_y;
  return sample;
}

}  // namespace tessera
