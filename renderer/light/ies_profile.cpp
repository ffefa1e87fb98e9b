#include "renderer/light/ies_profile.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// Where `angle` lies in rising `angles`: between entries `low` and `low + 1`, at `share` of the way.
struct Place {
  size_t low = 0;
  float share = 0;
};

Place PlaceOf(const std::vector<float>& angles, float angle) {
  if (angles.size() < 2) return {};
  const auto above = std::upper_bound(angles.begin(), angles.end(), angle);
  const auto low = static_cast<size_t>(
      std::clamp<ptrdiff_t>(above - angles.begin() - 1, 0, static_cast<ptrdiff_t>(angles.size()) - 2));
  return {low, std::clamp((angle - angles[low]) / (angles[low + 1] - angles[low]), 0.0f, 1.0f)};
}

float Degrees(float radians) {
  return radians * (180 / kPi);
}

// What each vertical angle contributes to the integral of sin(theta) times a function that is linear in
// between.
std::vector<double> SineWeights(const std::vector<float>& degrees) {
  std::vector<double> weights(degrees.size());
  for (size_t i = 0; i + 1 < degrees.size(); ++i) {
    const double a = Radians(degrees[i]), b = Radians(degrees[i + 1]);
    const double zeroth = std::cos(a) - std::cos(b);
    const double first = std::sin(b) - b * std::cos(b) - std::sin(a) + a * std::cos(a);
    weights[i] += (b * zeroth - first) / (b - a);
    weights[i + 1] += (first - a * zeroth) / (b - a);
  }
  return weights;
}

}  // namespace

float IesProfile::Fold(float horizontal) const {
  switch (symmetry_) {
    case Symmetry::kQuadrants:
      horizontal = 180 - std::abs(180 - horizontal);
      return 90 - std::abs(90 - horizontal);
    case Symmetry::kSides: return 180 - std::abs(180 - horizontal);
    case Symmetry::kFrontBack:
      if (horizontal < 90) return 180 - horizontal;
      return horizontal > 270 ? 540 - horizontal : horizontal;
    case Symmetry::kAxial:
    case Symmetry::kNone: break;
  }
  return horizontal;
}

float IesProfile::Intensity(Vec3 d) const {
  const float vertical = Degrees(std::acos(std::clamp(-d.z, -1.0f, 1.0f)));
  if (vertical < vertical_.front() || vertical > vertical_.back()) return 0;
  const float around = Degrees(std::atan2(d.y, d.x));
  const Place v = PlaceOf(vertical_, vertical),
              h = PlaceOf(horizontal_, Fold(around < 0 ? around + 360 : around));
  const size_t next_v = std::min(v.low + 1, vertical_.size() - 1);
  const size_t next_h = std::min(h.low + 1, horizontal_.size() - 1);
  return Lerp(h.share, Lerp(v.share, At(h.low, v.low), At(h.low, next_v)),
              Lerp(v.share, At(next_h, v.low), At(next_h, next_v)));
}

float IesProfile::Mean() const {
  const std::vector<double> weights = SineWeights(vertical_);
  const auto ring = [&](size_t horizontal) {
    double sum = 0;
    for (size_t i = 0; i < vertical_.size(); ++i) sum += weights[i] * At(horizontal, i);
    return sum;
  };
  if (symmetry_ == Symmetry::kAxial) return static_cast<float>(ring(0) / 2);
  double sum = 0;
  for (size_t i = 0; i + 1 < horizontal_.size(); ++i)
    sum += (ring(i) + ring(i + 1)) / 2 * (horizontal_[i + 1] - horizontal_[i]);
  return static_cast<float>(sum / (horizontal_.back() - horizontal_.front()) / 2);
}

}  // namespace tessera
