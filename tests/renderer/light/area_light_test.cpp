#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

constexpr char kEmitter[] = "AreaLightSource \"diffuse\" \"rgb L\" [ 2 2 2 ]\n";

TEST(AreaLight, SphereGivesTheIrradianceOfItsFormFactor) {
  LightScene lights;
  lights.Build(std::string(kEmitter) + "Shape \"sphere\"", {SphereShape({0, 0, 5}, 1.5f)});
  ASSERT_EQ(lights.error, "");
  EXPECT_EQ(lights.geometry.shapes[0].surface.area_light, 0);
  EXPECT_NEAR(Irradiance(lights.table, 0, At({0, 0, 0}, {0, 0, 1}), 64), 2 * kPi * Sqr(1.5f / 5), 5e-3f);
  // Tilted by 60 degrees, the sphere still above the horizon: the cosine.
  const Normal3 tilted{std::sin(Radians(60)), 0, std::cos(Radians(60))};
  EXPECT_NEAR(Irradiance(lights.table, 0, At({0, 0, 0}, tilted), 64), 2 * kPi * Sqr(1.5f / 5) / 2, 5e-3f);
}

TEST(AreaLight, DiskGivesTheIrradianceOfItsFormFactor) {
  LightScene lights;
  lights.Build(std::string(kEmitter) + "Shape \"disk\"", {DiskShape(2, 3, true)});
  ASSERT_EQ(lights.error, "");
  EXPECT_NEAR(Irradiance(lights.table, 0, At({0, 0, 0}, {0, 0, 1}), 128), 2 * kPi * 9 / (9 + 4), 0.02f);
}

// Irradiance from a polygon of radiance 1 (Lambert's formula).
float PolygonIrradiance(const std::vector<Point3>& corners, Normal3 n) {
  float sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = Normalize(corners[i]), b = Normalize(corners[(i + 1) % corners.size()]);
    sum += std::acos(Dot(a, b)) * Dot(n, Normalize(Cross(a, b)));
  }
  return std::abs(sum) / 2;
}

TEST(AreaLight, TriangleGivesTheIrradianceOfLambertsFormula) {
  const std::vector<Point3> corners = {{-1, 0, 2}, {1.5f, 2, 3}, {2, -1, 1}};
  for (const bool turned : {false, true}) {
    LightScene lights;
    const std::vector<uint32_t> order =
        turned ? std::vector<uint32_t>{0, 2, 1} : std::vector<uint32_t>{0, 1, 2};
    lights.Build(std::string(kEmitter) + "Shape \"trianglemesh\"", {MeshShape(corners, order)});
    ASSERT_EQ(lights.error, "");
    const float irradiance = Irradiance(lights.table, 0, At({0, 0, 0}, {0, 0, 1}), 64);
    const Normal3 n = Cross(corners[order[1]] - corners[0], corners[order[2]] - corners[0]);
    const bool faces = Dot(n, corners[0]) < 0;
    EXPECT_NEAR(irradiance, faces ? 2 * PolygonIrradiance(corners, {0, 0, 1}) : 0, 5e-3f);
  }
}

TEST(AreaLight, IsFoundBySamplingAloneIfScatteredRaysPassIt) {
  for (const HiddenFrom hidden_from : {kHiddenFromCamera, kHiddenFromShadowRays, kHiddenFromIndirect}) {
    Shape disk = DiskShape(0, 1);
    disk.surface.hidden_from = hidden_from;
    LightScene lights;
    lights.Build(std::string(kEmitter) + "Shape \"disk\"", {disk});
    ASSERT_EQ(lights.error, "");
    const auto sample = lights.table.Sample(0, At({0, 0, 2}), {0.3f, 0.4f}, FourWavelengths(100));
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->is_delta, hidden_from == kHiddenFromIndirect);
    EXPECT_EQ(lights.table.IsHitByScatteredRays(0), hidden_from != kHiddenFromIndirect);
  }
}

TEST(AreaLight, EmitsToOneSideUnlessTwoSided) {
  for (const bool two_sided : {false, true}) {
    LightScene lights;
    lights.Build("AreaLightSource \"diffuse\" \"bool twosided\" " +
                     std::string(two_sided ? "true" : "false") + "\nShape \"disk\"",
                 {DiskShape(0, 1)});
    ASSERT_EQ(lights.error, "");
    const SampledWavelengths wavelengths = FourWavelengths(100);
    EXPECT_TRUE(lights.table.Sample(0, At({0, 0, 2}), {0.3f, 0.4f}, wavelengths));
    EXPECT_EQ(lights.table.Sample(0, At({0, 0, -2}), {0.3f, 0.4f}, wavelengths).has_value(), two_sided);
    SurfaceInteraction hit;
    hit.n = {0, 0, 1};
    hit.area_light = 0;
    EXPECT_GT(lights.table.EmittedRadiance(0, hit, {0, 0.6f, 0.8f}, wavelengths)[0], 0);
    EXPECT_EQ(lights.table.EmittedRadiance(0, hit, {0, 0.6f, -0.8f}, wavelengths)[0] > 0, two_sided);
  }
}

TEST(AreaLight, EachPrimitiveEmitsThePower) {
  LightScene lights;
  const std::vector<Point3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {3, 0, 0}, {0, 3, 0}};
  lights.Build(R"(
    AreaLightSource "diffuse" "float power" [ 30 ]
    Shape "trianglemesh"
    AreaLightSource "diffuse" "float power" [ 30 ] "bool twosided" true "blackbody L" [ 3000 ]
    Shape "sphere")",
               {MeshShape(corners, {0, 1, 2, 3, 4, 5}), SphereShape({5, 5, 5}, 2)});
  ASSERT_EQ(lights.error, "");
  ASSERT_EQ(lights.table.size(), 3u);
  EXPECT_EQ(lights.geometry.shapes[1].surface.area_light, 2);
  SurfaceInteraction hit;
  hit.n = {0, 0, 1};
  const float areas[] = {0.5f, 4.5f, 2 * 4 * kPi * 4};
  for (int light = 0; light < 3; ++light) {
    const float radiance = Luminance([&](const SampledWavelengths& wavelengths) {
      return lights.table.EmittedRadiance(light, hit, {0, 0, 1}, wavelengths);
    });
    EXPECT_NEAR(radiance * kPi * areas[light], 30, 0.05f) << light;
  }
}

TEST(AreaLight, ImageIsMappedByTextureCoordinates) {
  LightScene lights;
  // Left dark, right bright; the bottom row twice as bright. v runs upwards.
  lights.files.files["screen.pfm"] = Pfm({{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {2, 2, 2}}, 2);
  lights.Build(R"(AreaLightSource "diffuse" "string filename" "screen.pfm" "float scale" 3 Shape "disk")",
               {DiskShape(0, 1)});
  ASSERT_EQ(lights.error, "");
  const auto radiance = [&](Point2 uv) {
    SurfaceInteraction hit;
    hit.n = {0, 0, 1};
    hit.uv = uv;
    return Luminance([&](const SampledWavelengths& wavelengths) {
      return lights.table.EmittedRadiance(0, hit, {0, 0, 1}, wavelengths);
    });
  };
  EXPECT_NEAR(radiance({0.1f, 0.1f}), 0, 1e-6f);
  EXPECT_NEAR(radiance({0.9f, 0.9f}), 3, 0.03f);
  EXPECT_NEAR(radiance({0.9f, 0.1f}), 6, 0.06f);
  EXPECT_NEAR(radiance({0.5f, 0.1f}), 3, 0.03f);  // bilinear
}

TEST(AreaLight, EmitsTheShareOfItsAlpha) {
  LightScene lights;
  Shape veiled = DiskShape(0, 1), hidden = DiskShape(0, 1), whole = DiskShape(0, 1);
  veiled.surface.alpha.constant = 0.25f;
  hidden.surface.alpha.constant = 0;
  lights.Build(std::string(kEmitter) + "Shape \"disk\" Shape \"disk\" Shape \"disk\"",
               {veiled, hidden, whole});
  ASSERT_EQ(lights.error, "");
  const float expected[] = {0.5f, 2, 2};
  for (int light = 0; light < 3; ++light) {
    const auto sample = lights.table.Sample(light, At({0, 0, 1}), {0.3f, 0.4f}, FourWavelengths(0));
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->is_delta, light == 1);
    EXPECT_NEAR(SampleLuminance(lights.table, light, At({0, 0, 1}), {0.3f, 0.4f}), expected[light], 5e-3f);
  }
}

TEST(AreaLight, PdfOfAHitIsThatOfTheSample) {
  LightScene lights;
  lights.Build("AreaLightSource \"diffuse\" \"bool twosided\" true Shape \"trianglemesh\"",
               {MeshShape({{-1, 0, 2}, {1.5f, 2, 3}, {2, -1, 1}}, {0, 2, 1})});
  ASSERT_EQ(lights.error, "");
  TestRandom random(1);
  const ReferencePoint reference = At({0, 0, 0}, {0, 0, 1});
  for (int i = 0; i < 500; ++i) {
    const auto sample = lights.table.Sample(0, reference, random.Next2<Point2>(), FourWavelengths(0));
    ASSERT_TRUE(sample);
    SurfaceInteraction hit;
    hit.p = sample->p;
    hit.n = sample->n;
    EXPECT_NEAR(lights.table.AreaLightPdf(0, reference, sample->wi, hit) / sample->pdf, 1, 2e-3f);
  }
}

TEST(AreaLight, OnAnInterfaceIsIgnoredWithAWarning) {
  LightScene lights;
  Shape shape = DiskShape(0, 1);
  shape.surface.is_interface = true;
  lights.Build("AreaLightSource \"diffuse\" Shape \"disk\"", {shape});
  ASSERT_EQ(lights.error, "");
  EXPECT_TRUE(lights.table.empty());
  EXPECT_EQ(lights.geometry.shapes[0].surface.area_light, -1);
  ASSERT_EQ(lights.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(lights.diagnostics.WarningTexts()[0],
            "lights.pbrt:3:1: the area light of a shape with an \"interface\" material is ignored");
}

}  // namespace
}  // namespace tessera
