#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

TEST(PointLight, RadianceFallsWithTheSquareOfTheDistance) {
  LightScene lights;
  lights.Build("LightSource \"point\" \"point3 from\" [ 1 0 0 ]");
  ASSERT_EQ(lights.error, "");
  ASSERT_EQ(lights.table.size(), 1u);
  EXPECT_NEAR(SampleLuminance(lights.table, 0, At({1, 0, 1}), {}), 1, 1e-4f);
  EXPECT_NEAR(SampleLuminance(lights.table, 0, At({1, 0, 3}), {}), 1 / 9.0f, 1e-5f);
  const auto sample = lights.table.Sample(0, At({1, 0, 3}), {}, FourWavelengths(0));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->wi, (Vec3{0, 0, -1}));
  EXPECT_EQ(sample->p, (Point3{1, 0, 0}));
  EXPECT_TRUE(sample->is_delta);
  EXPECT_EQ(sample->pdf, 1);
  EXPECT_FALSE(lights.table.Sample(0, At({1, 0, 0}), {}, FourWavelengths(0)));
}

TEST(PointLight, NormalisationRemovesTheMagnitudeOfSpectraButNotOfRgb) {
  LightScene lights;
  lights.Build(R"(
    LightSource "point" "spectrum I" [ 300 7 900 7 ]
    LightSource "point" "blackbody I" [ 4500 ]
    LightSource "point" "rgb I" [ 3 3 3 ]
    LightSource "point" "rgb I" [ 3 3 3 ] "float scale" [ 5 ])");
  ASSERT_EQ(lights.error, "");
  const float expected[] = {1, 1, 3, 15};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(SampleLuminance(lights.table, i, At({0, 0, 1}), {}) / expected[i], 1, 2e-3f) << i;
  }
}

// The luminous power through a sphere of radius 1 around the origin.
float PowerThroughSphere(const LightTable& table, int light) {
  constexpr int kSide = 100;
  const SampledWavelengths green = FourWavelengths(555 - kLambdaMin);
  double sum = 0;
  float ratio = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Point2 u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                   (static_cast<float>(i / kSide) + 0.5f) / kSide};
    const ReferencePoint reference = At(SampleUniformSphere(u));
    const auto sample = table.Sample(light, reference, {}, green);
    if (!sample) continue;
    if (ratio == 0) ratio = SampleLuminance(table, light, reference, {}) / sample->L[0];
    sum += static_cast<double>(sample->L[0]);
  }
  return static_cast<float>(sum / (kSide * kSide)) * 4 * kPi * ratio;
}

TEST(PowerOfLights, IsTheValueOfThePowerParameter) {
  LightScene lights;
  lights.files.files["map.pfm"] = Pfm({{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {0, 0, 0}}, 2);
  lights.Build(R"(
    LightSource "point" "float power" [ 20 ]
    LightSource "spot" "float power" [ 20 ] "float coneangle" [ 60 ] "float conedeltaangle" [ 30 ]
    LightSource "spot" "float power" [ 20 ] "float coneangle" [ 170 ] "blackbody I" [ 3000 ]
    LightSource "goniometric" "float power" [ 20 ] "string filename" [ "map.pfm" ]
    LightSource "projection" "float power" [ 20 ] "string filename" [ "map.pfm" ] "float fov" [ 100 ])");
  ASSERT_EQ(lights.error, "");
  for (int i = 0; i < 5; ++i) {
    // The power of a projection is computed from few pixels.
    const float tolerance = i == 4 ? 0.6f : 0.1f;
    EXPECT_NEAR(PowerThroughSphere(lights.table, i), 20, tolerance) << i;
  }
}

TEST(SpotLight, FadesSmoothlyFromTheInnerToTheOuterCone) {
  LightScene lights;
  lights.Build(R"(
    Translate 1 0 0
    LightSource "spot" "point3 from" [ 0 0 0 ] "point3 to" [ 0 5 0 ] "float coneangle" [ 40 ] "float conedeltaangle" [ 20 ])");
  ASSERT_EQ(lights.error, "");
  const auto at_angle = [&](float degrees) {
    const float angle = Radians(degrees);
    return SampleLuminance(lights.table, 0, At({1, std::cos(angle), std::sin(angle)}), {});
  };
  EXPECT_NEAR(at_angle(0), 1, 1e-4f);
  EXPECT_NEAR(at_angle(19.9f), 1, 1e-4f);
  EXPECT_EQ(at_angle(40.1f), 0);
  EXPECT_EQ(at_angle(180), 0);
  const float start = std::cos(Radians(20)), end = std::cos(Radians(40));
  EXPECT_NEAR(at_angle(std::acos((start + end) / 2) * 180 / kPi), 0.5f, 1e-3f);
  const float t = (std::cos(Radians(35)) - end) / (start - end);
  EXPECT_NEAR(at_angle(35), t * t * (3 - 2 * t), 1e-3f);
}

TEST(DistantLight, HasItsIlluminanceFromItsDirection) {
  LightScene lights;
  lights.Build(R"(
    LightSource "distant" "point3 from" [ 0 0 5 ] "point3 to" [ 0 0 0 ] "float illuminance" [ 7 ]
    Shape "sphere")",
               {SphereShape({0, 0, 0}, 2)});
  ASSERT_EQ(lights.error, "");
  EXPECT_NEAR(SampleLuminance(lights.table, 0, At({1, 1, 1}), {}), 7, 1e-3f);
  const auto sample = lights.table.Sample(0, At({1, 1, 1}), {}, FourWavelengths(0));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->wi, (Vec3{0, 0, 1}));
  EXPECT_GT(Distance(sample->p, {0, 0, 0}), 2);
  EXPECT_TRUE(sample->is_delta);
  EXPECT_TRUE(lights.table.infinite_lights().empty());
}

TEST(ProjectionLight, ImageIsUprightSeenFromTheLight) {
  LightScene lights;
  // Top left is bright.
  lights.files.files["slide.pfm"] = Pfm({{1, 1, 1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, 2);
  lights.Build(R"(LightSource "projection" "string filename" [ "slide.pfm" ] "float fov" [ 90 ])");
  ASSERT_EQ(lights.error, "");
  EXPECT_GT(SampleLuminance(lights.table, 0, At({-0.5f, 0.5f, 1}), {}), 0);
  EXPECT_EQ(SampleLuminance(lights.table, 0, At({0.5f, 0.5f, 1}), {}), 0);
  EXPECT_EQ(SampleLuminance(lights.table, 0, At({-0.5f, -0.5f, 1}), {}), 0);
  EXPECT_EQ(SampleLuminance(lights.table, 0, At({-0.5f, 1.1f, 1}), {}), 0);
  EXPECT_EQ(SampleLuminance(lights.table, 0, At({-0.5f, 0.5f, -1}), {}), 0);
}

TEST(GoniometricLight, MapIsOctahedralWithYUp) {
  LightScene lights;
  std::vector<Vec3> pixels(9, Vec3{0, 0, 0});
  pixels[4] = {2, 2, 2};  // the middle: the map's +z, the light's +y
  lights.files.files["map.pfm"] = Pfm(pixels, 3);
  lights.Build(R"(LightSource "goniometric" "string filename" [ "map.pfm" ])");
  ASSERT_EQ(lights.error, "");
  EXPECT_NEAR(SampleLuminance(lights.table, 0, At({0, 1, 0}), {}), 2, 1e-3f);
  EXPECT_EQ(SampleLuminance(lights.table, 0, At({0, 0, 1}), {}), 0);
  EXPECT_EQ(SampleLuminance(lights.table, 0, At({0, -1, 0}), {}), 0);
}

}  // namespace
}  // namespace tessera
