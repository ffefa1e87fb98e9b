#include "renderer/bssrdf/bssrdf.h"

#include <gtest/gtest.h>

#include "renderer/math/sampling.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

struct SphereHit {
  Point3 p;
  Normal3 n;
};
std::vector<SphereHit> HitsOf(const ProbeSegment& probe, Point3 center, float radius) {
  const Vec3 f = probe.from - center;
  const float a = LengthSquared(probe.along), b = Dot(f, probe.along), c = LengthSquared(f) - radius * radius;
  const float discriminant = b * b - a * c;
  std::vector<SphereHit> hits;
  if (discriminant <= 0) return hits;
  for (const float sign : {-1.0f, 1.0f}) {
    const float t = (-b + sign * std::sqrt(discriminant)) / a;
    if (t < 0 || t > 1) continue;
    const Point3 p = probe.from + probe.along * t;
    hits.push_back({p, (p - center) / radius});
  }
  return hits;
}

TEST(Bssrdf, ProbesMeetASphereWithTheirDensity) {
  const DiffusionProfile profile(0, 1.33f);
  // Small against the longest probes, so that all of it is within their reach.
  const float radius = 1;
  const Normal3 n = Normalize({1, 2, 3});
  const Bssrdf bssrdf(profile, n * radius, n, SampledSpectrum(0.05f, 0.1f, 0.2f, 0.3f),
                      SampledSpectrum(1.0f));
  TestRandom random(5);
  double area = 0, up = 0, squares = 0;
  constexpr int kCount = 400000;
  for (int i = 0; i < kCount; ++i) {
    const float u_axis = random.Next();
    const auto probe = bssrdf.SampleProbe(u_axis, random.Next2<Point2>());
    if (!probe) continue;
    double sum = 0;
    for (const SphereHit& hit : HitsOf(*probe, {0, 0, 0}, radius)) {
      const double weight = 1 / static_cast<double>(bssrdf.Pdf(hit.p, hit.n)[0]);
      sum += weight;
      if (Dot(hit.n, n) > 0.5f) up += weight / kCount;
    }
    area += sum / kCount;
    squares += sum * sum / kCount;
  }
  const double error = std::sqrt(squares / kCount);
  EXPECT_NEAR(area, 4 * M_PI, 5 * error + 0.03);
  EXPECT_NEAR(up, M_PI, 5 * error + 0.03);
  EXPECT_LT(error, 0.5);
}

TEST(Bssrdf, IntegralOverAPlaneIsTheEffectiveAlbedo) {
  const DiffusionProfile profile(0, 1.5f);
  const Bssrdf bssrdf(profile, {0, 0, 0}, {0, 0, 1}, SampledSpectrum(0.1f, 0.2f, 1.0f, 4.0f),
                      SampledSpectrum(2.0f));
  SampledSpectrum sum;
  for (int i = 0; i < 40000; ++i) {
    const float r = 1e-4f * std::exp(static_cast<float>(i) * 3e-4f), width = r * 3e-4f;
    sum += bssrdf.Evaluate({r, 0, 0}) * (2 * kPi * r * width);
  }
  for (int i = 0; i < 4; ++i) {
    const float sigma_a = SampledSpectrum(0.1f, 0.2f, 1.0f, 4.0f)[i];
    const float expected = profile.EffectiveAlbedo(profile.PlaceOf(2 / (2 + sigma_a)));
    EXPECT_NEAR(sum[i], expected, 0.01f * expected) << i;
  }
}

TEST(Bssrdf, NothingScattersWithoutScattering) {
  const DiffusionProfile profile(0, 1.5f);
  const Bssrdf clear(profile, {0, 0, 0}, {0, 0, 1}, SampledSpectrum(0.0f), SampledSpectrum(0.0f));
  EXPECT_FALSE(clear.SampleProbe(0.5f, {0.5f, 0.5f}));
  EXPECT_FALSE(AnyNonZero(clear.Evaluate({1, 0, 0})));
  EXPECT_FALSE(AnyNonZero(clear.Pdf({1, 0, 0}, {0, 0, 1})));
}

}  // namespace
}  // namespace tessera
