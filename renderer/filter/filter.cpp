#include "renderer/filter/filter.h"

#include <algorithm>
#include <cmath>

#include "renderer/description/parameter_reader.h"
#include "renderer/util/hash.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kKinds[] = {"box", "gaussian", "mitchell", "sinc", "triangle"};
constexpr int kIntervals = 512;    // per axis: far below what a pixel's samples can resolve
constexpr int kGuideParts = 1024;  // a power of two, so that u times it is exact: twice the intervals
constexpr float kRadiusMax = 64;   // pixels: wider filters are mistakes

// parameters: sigma. The value at the radius is subtracted, so that the filter ends at 0.
float Gaussian(float x, float radius, const float* parameters) {
  const float k = -1 / (2 * Sqr(parameters[0]));
  return std::max(0.0f, std::exp(k * x * x) - std::exp(k * radius * radius));
}

// parameters: B, C (Mitchell and Netravali 1988), stretched so that the radius is its 2.
float Mitchell(float x, float radius, const float* parameters) {
  const float b = parameters[0], c = parameters[1];
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

// parameters: tau, the lobes of the Lanczos window.
float WindowedSinc(float x, float radius, const float* parameters) {
  return std::abs(x) > radius ? 0 : Sinc(x) * Sinc(x / parameters[0]);
}

// Density (1 - |x| / radius) / radius.
float SampleTent(float u, float radius) {
  if (u < 0.5f) return radius * (std::sqrt(2 * u) - 1);
  return radius * (1 - std::sqrt(std::max(0.0f, 2 - 2 * u)));
}

}  // namespace

FilterAxis::FilterAxis(float radius, float (*f)(float, float, const float*), const float* parameters)
    : radius_(radius) {
  value_.resize(kIntervals + 1);
  cdf_.resize(kIntervals + 1);
  for (int i = 0; i <= kIntervals; ++i) {
    const float x = radius * (2.0f * i / kIntervals - 1);
    value_[i] = f(x, radius, parameters);
  }
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

// The last interval that begins at or before u: a step or two from where the guide points (Chen and Asau
// 1974).
int FilterAxis::IntervalOf(float u) const {
  int i = guide_[static_cast<int>(u * kGuideParts)];
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

FilterSample Filter::Sample(Point2 u) const {
  switch (kind_) {
    case Kind::kBox: return {{Lerp(u.x, -radius_.x, radius_.x), Lerp(u.y, -radius_.y, radius_.y)}, 1};
    case Kind::kTriangle: return {{SampleTent(u.x, radius_.x), SampleTent(u.y, radius_.y)}, 1};
    case Kind::kTabulated: break;
  }
  FilterSample sample;
  float sign_x, sign_y;
  sample.offset.x = x_.Sample(u.x, &sign_x);
  sample.offset.y = y_.Sample(u.y, &sign_y);
  sample.weight = sign_x * sign_y;
  return sample;
}

float Filter::Evaluate(Vec2 offset) const {
  if (std::abs(offset.x) > radius_.x || std::abs(offset.y) > radius_.y) return 0;
  switch (kind_) {
    case Kind::kBox: return 1;
    case Kind::kTriangle: return (radius_.x - std::abs(offset.x)) * (radius_.y - std::abs(offset.y));
    case Kind::kTabulated: break;
  }
  return x_.Evaluate(offset.x) * y_.Evaluate(offset.y);
}

Result<Filter> Filter::Read(const Entity& entity) {
  ParameterReader reader(entity);
  const std::string& kind = entity.kind;
  if (std::find(std::begin(kKinds), std::end(kKinds), kind) == std::end(kKinds)) {
    return ErrorAt(entity.location, "unknown filter \"" + kind + "\"" + DidYouMean(kind, kKinds));
  }
  const float radius = kind == "box" ? 0.5f : kind == "gaussian" ? 1.5f : kind == "sinc" ? 4.0f : 2.0f;
  Filter filter;
  filter.radius_ = {reader.Float("xradius", radius), reader.Float("yradius", radius)};
  const auto valid = [](float r) { return r > 0 && r <= kRadiusMax; };
  if (!valid(filter.radius_.x))
    reader.FailAt("xradius", "the filter radius must lie above 0 and at most 64 pixels");
  if (!valid(filter.radius_.y))
    reader.FailAt("yradius", "the filter radius must lie above 0 and at most 64 pixels");
  float parameters[2] = {0, 0};
  float (*f)(float, float, const float*) = nullptr;
  if (kind == "gaussian") {
    f = Gaussian;
    parameters[0] = reader.Float("sigma", 0.5f);
    if (!(parameters[0] > 0)) reader.FailAt("sigma", "sigma must be above 0");
  } else if (kind == "mitchell") {
    f = Mitchell;
    parameters[0] = reader.Float("B", 1.0f / 3);
    parameters[1] = reader.Float("C", 1.0f / 3);
  } else if (kind == "sinc") {
    f = WindowedSinc;
    parameters[0] = reader.Float("tau", 3);
    if (!(parameters[0] > 0)) reader.FailAt("tau", "tau must be above 0");
  }
  if (Result<void> done = reader.Finish(); !done) return done.error();
  filter.kind_ = kind == "box" ? Kind::kBox : kind == "triangle" ? Kind::kTriangle : Kind::kTabulated;
  if (f != nullptr) {
    filter.x_ = FilterAxis(filter.radius_.x, f, parameters);
    filter.y_ = FilterAxis(filter.radius_.y, f, parameters);
  }
  return filter;
}

}  // namespace tessera
