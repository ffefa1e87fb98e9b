// Means with their standard errors, for tests of estimates.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/chi_square.h"
#include "tests/renderer/bxdf/bxdf_examples.h"

namespace tessera {

struct Mean {
  double value = 0, error = 0;  // standard error
};

template <typename F>
Mean MeanOf(int count, const F& next) {
  double sum = 0, squares = 0;
  for (int n = 0; n < count; ++n) {
    const double x = next(n);
    sum += x;
    squares += x * x;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

// The albedo by sampling: the radiance in a uniform environment of radiance 1.
template <typename AnyBxdf>
Mean Furnace(const AnyBxdf& bxdf, float cos_o, int sample_count) {
  TestRandom random(17);
  const Vec3 wo = DirectionAt(cos_o, 1);
  return MeanOf(sample_count, [&](int) {
    const float uc = random.Next();
    const auto s = bxdf.Sample(wo, uc, random.Next2<Point2>());
    return s ? s->f[0] * AbsCosTheta(s->wi) / s->pdf : 0.0f;
  });
}

}  // namespace tessera
