#include "renderer/math/equal_area.h"
#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

constexpr const char* kPortal = " \"point3 portal\" [ -1 0 3  -1 0.5 3  1 0.5 3  1 0 3 ]";

// A picture of the sphere that varies slowly, with a brighter side.
Vec3 SmoothSky(Vec3 d) {
  return Vec3{1, 0.8f, 0.6f} * (1.2f + d.x) + Vec3{0.2f, 0.3f, 0.8f} * (1 + d.y) * (1 + d.y);
}

std::string SkyFile(int size) {
  std::vector<Vec3> pixels;
  for (int i = 0; i < size * size; ++i) {
    pixels.push_back(SmoothSky(
        EqualAreaSquareToSphere({(static_cast<float>(i % size) + 0.5f) / static_cast<float>(size),
                                 (static_cast<float>(i / size) + 0.5f) / static_cast<float>(size)})));
  }
  return Pfm(pixels, size);
}

void BuildPortal(LightScene& lights, int size = 64, const std::string& parameters = "") {
  lights.files.files["sky.pfm"] = SkyFile(size);
  lights.Build("Rotate 40 1 2 3\nLightSource \"infinite\" \"string filename\" \"sky.pfm\"" +
                   std::string(kPortal) + parameters + "\nShape \"sphere\"",
               {SphereShape({0, 0, 0}, 2)});
  ASSERT_EQ(lights.error, "");
}

bool PassesThrough(Point3 from, Vec3 d) {
  const float t = (3 - from.z) / d.z;
  const Point3 p = from + d * t;
  return t > 0 && std::abs(p.x) <= 1 && p.y >= 0 && p.y <= 0.5f;
}

TEST(PortalInfiniteLight, ShinesOnlyThroughItsPortal) {
  LightScene lights;
  BuildPortal(lights);
  TestRandom random(1);
  const SampledWavelengths wavelengths = FourWavelengths(200);
  for (const Point3 from : {Point3{0, 0, 0}, Point3{2, -1, 2.5f}, Point3{0.3f, 0.2f, 2.99f}}) {
    int different = 0;
    for (int i = 0; i < 100000; ++i) {
      const Vec3 d = SampleUniformSphere(random.Next2<Point2>());
      const bool is_lit = AnyNonZero(lights.table.InfiniteRadiance(0, from, d, 0, wavelengths));
      // Rounding moves a few directions across the edge.
      if (is_lit != PassesThrough(from, d)) ++different;
      EXPECT_EQ(is_lit, lights.table.InfiniteLightPdf(0, from, d, 0) > 0);
    }
    EXPECT_LE(different, 5);
  }
}

TEST(PortalInfiniteLight, HasTheRadianceOfItsPicture) {
  LightScene lights, open;
  BuildPortal(lights, 512, "\"float scale\" 3");
  open.files.files["sky.pfm"] = SkyFile(512);
  open.Build(R"(Rotate 40 1 2 3 LightSource "infinite" "string filename" "sky.pfm" "float scale" 3)");
  TestRandom random(2);
  const SampledWavelengths wavelengths = FourWavelengths(150);
  int compared = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 d = SampleUniformSphere(random.Next2<Point2>());
    const SampledSpectrum L = lights.table.InfiniteRadiance(0, {0, 0, 2.5f}, d, 0, wavelengths);
    if (!AnyNonZero(L)) continue;
    ++compared;
    EXPECT_NEAR(L[0] / open.table.InfiniteRadiance(0, {}, d, 0, wavelengths)[0], 1, 0.03f);
  }
  EXPECT_GT(compared, 1000);
}

TEST(PortalInfiniteLight, SamplesFollowTheirDensity) {
  LightScene lights;
  BuildPortal(lights, 8);
  TestRandom random(3);
  const SampledWavelengths wavelengths = FourWavelengths(200);
  for (const Point3 from : {Point3{0, 0, 0}, Point3{1.5f, -1, 2.8f}}) {
    // Over the points of the portal.
    const ChiSquareResult result = ChiSquare(
        {-1, 1, 0, 0.5, 24, 12, 200000},
        [&]() -> std::optional<Point2> {
          const auto s = lights.table.Sample(0, At(from), random.Next2<Point2>(), wavelengths);
          if (!s) return std::nullopt;
          const Point3 p = from + s->wi * ((3 - from.z) / s->wi.z);
          return Point2{std::clamp(p.x, -1.0f, 1.0f), std::clamp(p.y, 0.0f, 0.5f)};
        },
        [&](float x, float y) {
          const Vec3 d = Point3{x, y, 3} - from;
          const float squared = LengthSquared(d);
          const Vec3 wi = d / std::sqrt(squared);
          return lights.table.InfiniteLightPdf(0, from, wi, 0) * wi.z / squared;
        });
    EXPECT_TRUE(result.Passes(2)) << result.text;
    EXPECT_NEAR(result.pdf_total, 1, 0.01);
  }
}

TEST(PortalInfiniteLight, SamplesCarryTheRadianceAndDensityOfTheirDirection) {
  LightScene lights;
  BuildPortal(lights);
  TestRandom random(4);
  const SampledWavelengths wavelengths = FourWavelengths(200);
  const Point3 from{0.5f, -1, 1};
  int different = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto s = lights.table.Sample(0, At(from), random.Next2<Point2>(), wavelengths);
    ASSERT_TRUE(s);
    ASSERT_NEAR(Length(s->wi), 1, 1e-5f);
    ASSERT_TRUE(PassesThrough(from, s->wi));
    const float pdf = lights.table.InfiniteLightPdf(0, from, s->wi, 0);
    const SampledSpectrum radiance = lights.table.InfiniteRadiance(0, from, s->wi, 0, wavelengths);
    // Rounding moves a few directions across the edge of a texel.
    if (std::abs(radiance[0] / s->Radiance(wavelengths)[0] - 1) > 1e-4f || std::abs(pdf / s->pdf - 1) > 1e-4f)
      ++different;
  }
  EXPECT_LE(different, 5);
}

TEST(PortalInfiniteLight, BringsTheIrradianceOfTheDirectionsThroughIt) {
  LightScene lights;
  BuildPortal(lights);
  const ReferencePoint reference = At({0, 0, 1}, {0, 0, 1});
  const SampledWavelengths green = FourWavelengths(555 - kLambdaMin);
  double sampled = 0, truth = 0;
  TestRandom random(5);
  constexpr int kCount = 400000;
  for (int i = 0; i < kCount; ++i) {
    const auto s = lights.table.Sample(0, reference, random.Next2<Point2>(), green);
    ASSERT_TRUE(s);
    sampled += static_cast<double>(s->Radiance(green)[0]) * s->wi.z / s->pdf;
    const Vec3 d = SampleCosineHemisphere(random.Next2<Point2>());
    truth += static_cast<double>(lights.table.InfiniteRadiance(0, reference.p, d, 0, green)[0]) * kPi;
  }
  EXPECT_NEAR(sampled / truth, 1, 0.02);
}

TEST(PortalInfiniteLight, IsNeitherSampledNorFoundFromBehind) {
  LightScene lights;
  BuildPortal(lights);
  const SampledWavelengths wavelengths = FourWavelengths(200);
  for (const Point3 from : {Point3{0, 0, 3}, Point3{0, 0.2f, 4}}) {
    EXPECT_FALSE(lights.table.Sample(0, At(from), {0.5f, 0.5f}, wavelengths));
    EXPECT_FALSE(AnyNonZero(lights.table.InfiniteRadiance(0, from, {0, 0, 1}, 0, wavelengths)));
    EXPECT_EQ(lights.table.InfiniteLightPdf(0, from, {0, 0, 1}, 0), 0);
  }
}

TEST(PortalInfiniteLight, OfOneColourHasTheLuminanceOfItsRgb) {
  LightScene lights;
  lights.Build(std::string(R"(LightSource "infinite" "rgb L" [ 2 3 4 ])") + kPortal +
               "\nLightSource \"infinite\"" + kPortal + "\nLightSource \"infinite\" \"blackbody L\" 5000" +
               kPortal);
  ASSERT_EQ(lights.error, "");
  const auto luminance = [&](int light) {
    return Luminance([&](const SampledWavelengths& wavelengths) {
      return lights.table.InfiniteRadiance(light, {0, 0.2f, 0}, {0, 0, 1}, 0, wavelengths);
    });
  };
  EXPECT_NEAR(luminance(0), 0.2126f * 2 + 0.7152f * 3 + 0.0722f * 4, 0.03f);
  EXPECT_NEAR(luminance(1), 1, 0.01f);
  ASSERT_EQ(lights.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(lights.diagnostics.warnings()[0].message,
            "light through a portal is stored as RGB: \"L\" is converted to sRGB");
}

TEST(PortalInfiniteLight, OfASkewedPortalUsesARectangleWithAWarning) {
  LightScene lights;
  lights.Build(R"(LightSource "infinite" "point3 portal" [ -1 0 3  -0.5 1 3  1.5 1 3  1 0 3 ])");
  ASSERT_EQ(lights.error, "");
  ASSERT_EQ(lights.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(lights.diagnostics.warnings()[0].Text(),
            "lights.pbrt:3:24: the portal is not a rectangle: one with its first and third corner is used");
  TestRandom random(6);
  for (int i = 0; i < 1000; ++i) {
    const auto s = lights.table.Sample(0, At({0, 0, 0}), random.Next2<Point2>(), FourWavelengths(100));
    ASSERT_TRUE(s);
    EXPECT_NEAR(Length(s->wi), 1, 1e-5f);
  }
}

TEST(PortalInfiniteLight, OfABlackSkyIsNotSampled) {
  LightScene lights;
  lights.files.files["black.pfm"] = Pfm(std::vector<Vec3>(16, {0, -1, 0}), 4);
  lights.Build(std::string(R"(LightSource "infinite" "string filename" "black.pfm")") + kPortal);
  ASSERT_EQ(lights.error, "");
  EXPECT_FALSE(lights.table.Choose(At({0, 0, 0}), 0.5f));
  EXPECT_FALSE(lights.table.Sample(0, At({0, 0, 0}), {0.5f, 0.5f}, FourWavelengths(100)));
}

// The brightest finite pixels must not make densities or choices infinite.
TEST(LightImages, OfExtremeAndNegativePixelsGiveFiniteSamples) {
  const float huge = std::numeric_limits<float>::max();
  LightScene lights;
  lights.files.files["huge.pfm"] = Pfm({{huge, huge, huge}, {-huge, 1, 0}, {0, 0, 0}, {huge, 0, 1}}, 2);
  lights.Build(R"(LightSource "infinite" "string filename" "huge.pfm")" + std::string(kPortal) + R"(
    LightSource "infinite" "string filename" "huge.pfm"
    LightSource "goniometric" "string filename" "huge.pfm"
    LightSource "projection" "string filename" "huge.pfm"
    AreaLightSource "diffuse" "string filename" "huge.pfm" "float scale" 1e10
    Shape "sphere")",
               {SphereShape({0, 0, 2}, 0.5f)});
  ASSERT_EQ(lights.error, "");
  TestRandom random(7);
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    const ReferencePoint reference = At({0, 0.2f, 0.5f}, {0, 0, 1});
    const auto chosen = lights.table.Choose(reference, random.Next());
    ASSERT_TRUE(chosen);
    EXPECT_TRUE(chosen->pmf > 0 && chosen->pmf <= 1);
    const SampledWavelengths wavelengths = FourWavelengths(200);
    const auto s = lights.table.Sample(chosen->light, reference, random.Next2<Point2>(), wavelengths);
    if (!s) continue;
    ++found;
    EXPECT_TRUE(s->pdf > 0 && std::isfinite(s->pdf)) << chosen->light;
    const float radiance = s->Radiance(wavelengths)[0];
    EXPECT_TRUE(radiance >= 0 && !std::isnan(radiance)) << chosen->light;
  }
  EXPECT_GT(found, 100);
}

}  // namespace
}  // namespace tessera
