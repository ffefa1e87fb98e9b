#include <numbers>

#include "renderer/math/equal_area.h"
#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

constexpr int kSize = 16;

std::vector<Vec3> RandomSky(uint64_t seed) {
  TestRandom random(seed);
  std::vector<Vec3> pixels(kSize * kSize);
  for (Vec3& pixel : pixels) {
    const float value = random.Next();
    pixel = Vec3{1, 0.8f, 0.6f} * (value * value * value * 5);
  }
  pixels[37] = {40, 30, 20};  // a sun
  return pixels;
}

void BuildSky(LightScene& lights, const std::string& parameters = "", const std::string& transform = "") {
  lights.files.files["sky.pfm"] = Pfm(RandomSky(1), kSize);
  lights.Build("Rotate 40 1 2 3\n" + transform +
                   "\nLightSource \"infinite\" \"string filename\" [ \"sky.pfm\" ] " + parameters +
                   "\nShape \"sphere\"",
               {SphereShape({0, 0, 0}, 2)});
  ASSERT_EQ(lights.error, "");
}

TEST(ConstantInfiniteLight, IlluminanceIsMeasuredOnAPlane) {
  LightScene lights;
  lights.Build(R"(
    LightSource "infinite" "rgb L" [ 2 2 2 ]
    LightSource "infinite" "blackbody L" [ 5000 ] "float illuminance" [ 10 ])");
  ASSERT_EQ(lights.error, "");
  const auto radiance = [&](int light) {
    return Luminance([&](const SampledWavelengths& wavelengths) {
      return lights.table.InfiniteRadiance(light, {}, {0, 1, 0}, 0, wavelengths);
    });
  };
  EXPECT_NEAR(radiance(0), 2, 5e-3f);
  EXPECT_NEAR(radiance(1) * kPi, 10, 1e-2f);
  EXPECT_EQ(lights.table.infinite_lights().size(), 2u);
}

TEST(ConstantInfiniteLight, IsFoundByEscapingRaysOnly) {
  LightScene lights;
  lights.Build(R"(LightSource "infinite" LightSource "point")");
  ASSERT_EQ(lights.error, "");
  for (const float u : {0.0f, 0.3f, 0.99f}) {
    const auto chosen = lights.table.Choose(At({0, 0, 1}), u);
    ASSERT_TRUE(chosen);
    EXPECT_EQ(chosen->light, 1);
    EXPECT_EQ(chosen->pmf, 1);
  }
  EXPECT_EQ(lights.table.ChoosePmf(At({0, 0, 1}), 0), 0);
  EXPECT_EQ(lights.table.InfiniteLightPdf(0, {}, {0, 0, 1}, 0), 0);
  EXPECT_FALSE(lights.table.Sample(0, At({0, 0, 1}), {0.5f, 0.5f}, FourWavelengths(0)));
}

TEST(ImageInfiniteLight, SamplesFollowTheirDensity) {
  LightScene lights;
  BuildSky(lights);
  TestRandom random(2);
  const SampledWavelengths wavelengths = FourWavelengths(200);
  const auto sample = [&]() -> std::optional<Vec3> {
    const auto s = lights.table.Sample(0, At({0, 0, 0}), random.Next2<Point2>(), wavelengths);
    if (!s) return std::nullopt;
    return s->wi;
  };
  // Counted per texel, where the density is constant, by mapping the direction back.
  const Transform light_from_render = Rotate(40, {1, 2, 3}).Inverse();
  constexpr int kDraws = 200000;
  std::vector<chi_square::Cell> cells(kSize * kSize);
  for (int i = 0; i < kSize * kSize; ++i) {
    const Point2 p{(static_cast<float>(i % kSize) + 0.5f) / kSize,
                   (static_cast<float>(i / kSize) + 0.5f) / kSize};
    const Vec3 wi = light_from_render.Inverse().ToVector(EqualAreaSquareToSphere(p));
    cells[static_cast<size_t>(i)].expected =
        static_cast<double>(lights.table.InfiniteLightPdf(0, {}, wi, 0)) * 4 * kPi / (kSize * kSize) * kDraws;
  }
  for (int i = 0; i < kDraws; ++i) {
    const auto wi = sample();
    ASSERT_TRUE(wi);
    const Point2 p = EqualAreaSphereToSquare(Normalize(light_from_render.ToVector(*wi)));
    ++cells[static_cast<size_t>(p.y * kSize) * kSize + static_cast<size_t>(p.x * kSize)].observed;
  }
  std::string text;
  EXPECT_GT(chi_square::PooledPValue(cells, text), 1e-4) << text;
}

TEST(ImageInfiniteLight, SamplesCarryTheRadianceAndDensityOfTheirDirection) {
  LightScene lights;
  BuildSky(lights);
  TestRandom random(3);
  const SampledWavelengths wavelengths = FourWavelengths(200);
  int different = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto s = lights.table.Sample(0, At({1, 0, 0}), random.Next2<Point2>(), wavelengths);
    ASSERT_TRUE(s);
    ASSERT_NEAR(Length(s->wi), 1, 1e-5f);
    ASSERT_GT(Length(s->p), 2);
    const SampledSpectrum radiance = lights.table.InfiniteRadiance(0, {}, s->wi, 0, wavelengths);
    const float pdf = lights.table.InfiniteLightPdf(0, {}, s->wi, 0);
    // Rounding moves a few directions across the edge of a texel.
    if (std::abs(radiance[0] / s->Radiance(wavelengths)[0] - 1) > 1e-4f || std::abs(pdf / s->pdf - 1) > 1e-4f)
      ++different;
  }
  EXPECT_LE(different, 5);
}

// By light and direction sampling together, relative to the truth.
double EstimateRadiance(const LightScene& lights) {
  const SampledWavelengths wavelengths = FourWavelengths(200);
  double truth = 0, estimate = 0;
  constexpr int kSide = 400;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Point2 u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                   (static_cast<float>(i / kSide) + 0.5f) / kSide};
    const Vec3 w = SampleUniformSphere(u);
    const float radiance = lights.table.InfiniteRadiance(0, {}, w, 0, wavelengths)[0];
    const float pdf = lights.table.InfiniteLightPdf(0, {}, w, 0);
    truth += static_cast<double>(radiance) / UniformSpherePdf();
    estimate += static_cast<double>(radiance) / (UniformSpherePdf() + pdf);
    const auto s = lights.table.Sample(0, At({0, 0, 0}), u, wavelengths);
    if (s) estimate += static_cast<double>(s->Radiance(wavelengths)[0]) / (s->pdf + UniformSpherePdf());
  }
  return estimate / truth;
}

TEST(ImageInfiniteLight, LightAndDirectionSamplingTogetherFindTheWholeRadiance) {
  for (const char* transform : {"", "Scale -2 2 2", "Scale 4 1 0.5"}) {
    LightScene lights;
    BuildSky(lights, "\"float scale\" [ 3 ]", transform);
    EXPECT_NEAR(EstimateRadiance(lights), 1, 2e-3) << transform;
  }
}

double IntegrateDensity(const LightScene& lights) {
  constexpr int kSide = 1500;
  double sum = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Point2 u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                   (static_cast<float>(i / kSide) + 0.5f) / kSide};
    sum += static_cast<double>(lights.table.InfiniteLightPdf(0, {}, SampleUniformSphere(u), 0));
  }
  return sum / (kSide * kSide) * 4 * std::numbers::pi;
}

TEST(ImageInfiniteLight, DensitiesArePerSolidAngleAlsoUnderATransformThatStretches) {
  for (const char* transform : {"Scale 3 1 0.6", "Transform [ 1 0 0 0  1 1 0 0  0 0 1 0  0 0 0 1 ]"}) {
    LightScene lights;
    BuildSky(lights, "", transform);
    EXPECT_NEAR(IntegrateDensity(lights), 1, 2e-3) << transform;
    TestRandom random(5);
    const SampledWavelengths wavelengths = FourWavelengths(200);
    int different = 0;
    for (int i = 0; i < 1000; ++i) {
      const auto s = lights.table.Sample(0, At({1, 0, 0}), random.Next2<Point2>(), wavelengths);
      ASSERT_TRUE(s);
      // Rounding moves a few directions across the edge of a texel.
      const float pdf = lights.table.InfiniteLightPdf(0, {}, s->wi, 0);
      if (std::abs(pdf / s->pdf - 1) > 1e-3f) ++different;
    }
    EXPECT_LE(different, 5) << transform;
  }
}

TEST(ImageInfiniteLight, TexelsHaveTheLuminanceOfTheirRgb) {
  LightScene lights;
  BuildSky(lights, "\"float scale\" [ 3 ]");
  const Vec3 sun = EqualAreaSquareToSphere({5.5f / kSize, 2.5f / kSize});
  const Vec3 d = Rotate(40, {1, 2, 3}).ToVector(sun);
  const float luminance = Luminance([&](const SampledWavelengths& wavelengths) {
    return lights.table.InfiniteRadiance(0, {}, d, 0, wavelengths);
  });
  const float expected = 3 * (0.2126f * 40 + 0.7152f * 30 + 0.0722f * 20);
  EXPECT_NEAR(luminance / expected, 1, 0.01f);
}

TEST(ImageInfiniteLight, IlluminanceIsMeasuredAsPbrtDoes) {
  LightScene lights;
  lights.files.files["white.pfm"] = Pfm(std::vector<Vec3>(kSize * kSize, {1, 1, 1}), kSize);
  lights.Build(R"(LightSource "infinite" "string filename" [ "white.pfm" ] "float illuminance" [ 10 ])");
  ASSERT_EQ(lights.error, "");
  const float luminance = Luminance([&](const SampledWavelengths& wavelengths) {
    return lights.table.InfiniteRadiance(0, {}, {0, 0, 1}, 0, wavelengths);
  });
  // pbrt measures half of the true pi; the image has few texels.
  EXPECT_NEAR(luminance / (10 / (kPi / 2)), 1, 0.03f);
}

TEST(ImageInfiniteLight, OfOneColourIsSampledUniformly) {
  LightScene lights;
  lights.files.files["white.pfm"] = Pfm(std::vector<Vec3>(kSize * kSize, {1, 1, 1}), kSize);
  lights.Build(R"(LightSource "infinite" "string filename" [ "white.pfm" ])");
  ASSERT_EQ(lights.error, "");
  EXPECT_NEAR(lights.table.InfiniteLightPdf(0, {}, {0, 0.6f, 0.8f}, 0), UniformSpherePdf(), 1e-6f);
}

}  // namespace
}  // namespace tessera
