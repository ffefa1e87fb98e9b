// Filters that are the product of one function of x and one of y, each tabulated: "gaussian", "mitchell" and
// "sinc".
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "renderer/filter/filter_reader.h"

namespace tessera {

// One axis of a separable filter as a piecewise linear function over [-radius, radius], sampled by inversion.
class FilterAxis {
 public:
  // `f`, a symmetric function, is evaluated at evenly spaced nodes.
  FilterAxis(float radius, const std::function<float(float x)>& f);

  // An offset with density |f|, and the sign of f there.
  float Sample(float u, float* sign) const;
  float Evaluate(float x) const;
  float radius() const { return radius_; }

 private:
  int IntervalOf(float u) const;  // u in [0, 1)

  float radius_;
  std::vector<float> value_;     // at the nodes
  std::vector<float> cdf_;       // of |f| up to each node, 1 at the last
  std::vector<uint16_t> guide_;  // the interval of the least u of each of equal parts of [0, 1)
};

class TabulatedFilter {
 public:
  static TabulatedFilter ReadGaussian(ParameterReader& reader);
  static TabulatedFilter ReadMitchell(ParameterReader& reader);
  static TabulatedFilter ReadSinc(ParameterReader& reader);

  TabulatedFilter(FilterAxis x, FilterAxis y) : x_(std::move(x)), y_(std::move(y)) {}

  FilterSample Sample(Point2 u) const;
  float Evaluate(Vec2 offset) const { return x_.Evaluate(offset.x) * y_.Evaluate(offset.y); }
  Vec2 radius() const { return {x_.radius(), y_.radius()}; }

 private:
  FilterAxis x_, y_;
};

}  // namespace tessera
