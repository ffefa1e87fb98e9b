// The mixture draws directions with the density that it divides by.
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "renderer/integrator/mixture_integrator.h"
#include "renderer/shape/shape_interaction.h"
#include "tests/chi_square.h"
#include "tests/renderer/scene/built_world.h"

namespace tessera {
namespace {

constexpr int kTests = 9;  // chi-square tests in this file

// A world and a point on a surface of it.
struct Place {
  std::unique_ptr<World> built;
  const World& world;
  SurfaceInteraction interaction;
  Bsdf bsdf;
  SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(0.3f);

  explicit Place(const char* text) : built(BuiltWorld(text)), world(*built) {}
};

// The point that the ray from the camera along d hits.
std::unique_ptr<Place> PlaceAlong(const char* text, Vec3 d) {
  auto place = std::make_unique<Place>(text);
  const World& world = place->world;
  const Ray ray{{0, 0, 0}, Normalize(d)};
  Hit hit;
  EXPECT_TRUE(world.accelerator->Intersect(ray, &hit));
  place->interaction = MakeInteraction(world.geometry, hit, ray);
  place->bsdf = world.materials.Evaluate(place->interaction.material, world.textures, {}, place->interaction,
                                         place->wavelengths);
  return place;
}

ChiSquareResult TestMixtureAt(const Place& place, uint64_t seed) {
  const LightDirections lights(place.world);
  TestRandom random(seed);
  const auto sample = [&]() -> std::optional<Vec3> {
    const float u_choice = random.Next();
    const Point2 u = random.Next2<Point2>();
    const auto drawn = SampleMixture(lights, place.interaction, place.bsdf, u_choice, u, place.wavelengths);
    if (!drawn || drawn->is_specular) return std::nullopt;
    return drawn->ray.d;
  };
  // Absorbed directions are not drawn.
  const auto pdf = [&](Vec3 w) {
    if (!AnyNonZero(place.bsdf.Evaluate(place.interaction.wo, w).f)) return 0.0f;
    return MixturePdf(lights, place.interaction, place.bsdf, w, place.wavelengths);
  };
  return ChiSquareSphere<Vec3>(sample, pdf, 24, 32, 200000);
}

TEST(Mixture, DirectionsFollowTheDensityUnderALampOfTriangles) {
  const auto place = PlaceAlong(kDiffuseBox, {0.3f, -0.8f, 1});
  const ChiSquareResult result = TestMixtureAt(*place, 1);
  EXPECT_TRUE(result.Passes(kTests)) << result.text;
  EXPECT_GT(result.pdf_total, 0.9);
}

// The mean of 1 / density over all samples, counting those in a cell, is the solid angle of the cell. This
// chi-square test needs no quadrature, and the density of a cylinder has poles at its silhouettes.
ChiSquareResult TestReciprocalsAt(const Place& place, uint64_t seed) {
  constexpr int kCellsZ = 9, kCellsPhi = 12, kSamples = 300000;
  constexpr double kZMin = 0.1;  // cosine: 1 / density is unbounded at the horizon
  constexpr double kCellAngle = 2 * std::numbers::pi * (1 - kZMin) / (kCellsZ * kCellsPhi);
  const LightDirections lights(place.world);
  const Frame frame = Frame::FromZ(FaceForward(place.interaction.shading.n, place.interaction.wo));
  TestRandom random(seed);
  std::array<double, kCellsZ * kCellsPhi> sums{}, squares{};
  for (int i = 0; i < kSamples; ++i) {
    const float u_choice = random.Next();
    const Point2 u = random.Next2<Point2>();
    const auto drawn = SampleMixture(lights, place.interaction, place.bsdf, u_choice, u, place.wavelengths);
    if (!drawn) continue;
    const Vec3 w = frame.ToLocal(drawn->ray.d);
    const double z = std::min(1.0, static_cast<double>(w.z));
    if (z < kZMin) continue;
    const double phi = std::atan2(w.y, w.x) + std::numbers::pi;
    const int row = std::min(static_cast<int>((z - kZMin) / (1 - kZMin) * kCellsZ), kCellsZ - 1);
    const int column = std::min(static_cast<int>(phi / (2 * std::numbers::pi) * kCellsPhi), kCellsPhi - 1);
    const double reciprocal = 1.0 / drawn->density;
    sums[row * kCellsPhi + column] += reciprocal;
    squares[row * kCellsPhi + column] += reciprocal * reciprocal;
  }
  double statistic = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    const double mean = sums[i] / kSamples;
    const double variance = (squares[i] / kSamples - mean * mean) / kSamples;
    statistic += Sqr(mean - kCellAngle) / variance;
  }
  ChiSquareResult result;
  result.p_value = chi_square::PValue(statistic, static_cast<int>(sums.size()));
  result.text = "chi2=" + std::to_string(statistic) + " cells=" + std::to_string(sums.size());
  return result;
}

TEST(Mixture, DirectionsFollowTheDensityWhereLightsHideLights) {
  const Vec3 directions[] = {{0.1f, -0.4f, 1}, {-0.5f, -0.5f, 1}, {0.4f, -0.2f, 1}};
  for (uint64_t i = 0; i < 3; ++i) {
    const auto place = PlaceAlong(kHiddenLights, directions[i]);
    const ChiSquareResult result = TestReciprocalsAt(*place, 2 + i);
    EXPECT_TRUE(result.Passes(kTests)) << i << ": " << result.text;
  }
}

TEST(Mixture, DirectionsFollowTheDensityOnRoughMetalUnderSkies) {
  const auto place = PlaceAlong(kSkies, {0.22f, 0, 1});
  const ChiSquareResult result = TestMixtureAt(*place, 5);
  EXPECT_TRUE(result.Passes(kTests)) << result.text;
}

TEST(Mixture, DirectionsFollowTheDensityInsideALamp) {
  const auto place = PlaceAlong(kInsideALamp, {-0.6f, 0.3f, 1});
  const ChiSquareResult result = TestMixtureAt(*place, 6);
  EXPECT_TRUE(result.Passes(kTests)) << result.text;
}

TEST(Mixture, DirectionsFollowTheDensityInAMedium) {
  const auto place = PlaceAlong(kDiffuseBox, {0, 0, 1});
  const LightDirections lights(place->world);
  const Ray ray{{0.3f, 0.2f, 2}, Normalize(Vec3{0.5f, -0.4f, 1})};
  const PhaseFunction phase(0.6f);
  TestRandom random(8);
  const auto sample = [&]() -> std::optional<Vec3> {
    const float u_choice = random.Next();
    const Point2 u = random.Next2<Point2>();
    const auto drawn = SampleMixture(lights, ray, phase, u_choice, u, place->wavelengths);
    if (!drawn) return std::nullopt;
    EXPECT_NEAR(drawn->weight[0], phase.Evaluate(-ray.d, drawn->ray.d) / drawn->density, 1e-4f);
    return drawn->ray.d;
  };
  const auto pdf = [&](Vec3 w) { return MixturePdf(lights, ray, phase, w, place->wavelengths); };
  const ChiSquareResult result = ChiSquareSphere<Vec3>(sample, pdf, 24, 32, 200000);
  EXPECT_TRUE(result.Passes(kTests)) << result.text;
}

// Every weight is f |cos| over the density that MixturePdf gives for the drawn direction.
TEST(Mixture, WeightIsTheBsdfOverTheDensityOfTheDrawnDirection) {
  for (const char* text : {kDiffuseBox, kHiddenLights, kSkies, kInsideALamp}) {
    const auto place = PlaceAlong(text, {0.2f, -0.5f, 1});
    const LightDirections lights(place->world);
    TestRandom random(7);
    int drawn_count = 0;
    for (int i = 0; i < 2000; ++i) {
      const float u_choice = random.Next();
      const Point2 u = random.Next2<Point2>();
      const auto drawn =
          SampleMixture(lights, place->interaction, place->bsdf, u_choice, u, place->wavelengths);
      if (!drawn) continue;
      ++drawn_count;
      const float pdf = MixturePdf(lights, place->interaction, place->bsdf, drawn->ray.d, place->wavelengths);
      ASSERT_NEAR(drawn->density, pdf, 2e-3f * pdf);
      const SampledSpectrum f = place->bsdf.Evaluate(place->interaction.wo, drawn->ray.d).f;
      const float cosine = AbsDot(drawn->ray.d, place->interaction.shading.n);
      ASSERT_NEAR(drawn->weight[0], f[0] * cosine / drawn->density, 1e-4f * drawn->weight[0]);
    }
    EXPECT_GT(drawn_count, 800);
  }
}

TEST(Mixture, DrawsFromTheBsdfAloneIfNoLightIsSampled) {
  const auto place = PlaceAlong(R"(
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material "diffuse"
Shape "disk" "float radius" 9 "float height" 5
)",
                                {0, 0, 1});
  const LightDirections lights(place->world);
  EXPECT_TRUE(lights.empty());
  const auto drawn =
      SampleMixture(lights, place->interaction, place->bsdf, 0.01f, {0.3f, 0.6f}, place->wavelengths);
  ASSERT_TRUE(drawn);
  EXPECT_NEAR(drawn->weight[0], 0.5f, 1e-4f);
}

}  // namespace
}  // namespace tessera
