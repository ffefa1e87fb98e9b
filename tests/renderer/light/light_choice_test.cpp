#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

// A point light, a distant one, an environment, and an emitting mesh of many triangles.
void BuildMany(LightScene& lights, LightSamplerKind light_sampler) {
  std::vector<Point3> points;
  std::vector<uint32_t> indices;
  TestRandom random(1);
  for (uint32_t i = 0; i < 40; ++i) {
    const Point2 at = random.Next2<Point2>();
    for (const Vec3 corner : {Vec3{0, 0, 0}, Vec3{0, 0.1f, 0}, Vec3{0.1f, 0, 0}}) {
      points.push_back(Vec3{at.x * 8 - 4, at.y * 8 - 4, 2} + corner);
      indices.push_back(static_cast<uint32_t>(indices.size()));
    }
  }
  lights.files.files["sky.pfm"] = Pfm({{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}}, 2);
  lights.Build(R"(
    LightSource "point" "point3 from" [ 0 0 1 ]
    LightSource "distant"
    LightSource "infinite"
    LightSource "infinite" "string filename" "sky.pfm"
    AreaLightSource "diffuse" "float scale" 100
    Shape "trianglemesh")",
               {MeshShape(points, indices)}, light_sampler);
  ASSERT_EQ(lights.error, "");
  ASSERT_EQ(lights.table.size(), 44u);
}

class LightChoice : public testing::TestWithParam<std::string_view> {
 protected:
  static LightSamplerKind Sampler() { return LightSamplers().Find(GetParam())->reader; }
};

TEST_P(LightChoice, FrequenciesMatchTheProbabilitiesWhichSumToOne) {
  LightScene lights;
  BuildMany(lights, Sampler());
  const ReferencePoint reference = At({0.5f, -1, 0}, {0, 0, 1});
  constexpr int kDraws = 100000;
  std::vector<chi_square::Cell> cells(44);
  double total = 0;
  for (int light = 0; light < 44; ++light) {
    const float pmf = lights.table.ChoosePmf(reference, light);
    total += static_cast<double>(pmf);
    cells[static_cast<size_t>(light)].expected = static_cast<double>(pmf) * kDraws;
  }
  EXPECT_NEAR(total, 1, 1e-4);
  TestRandom random(2);
  for (int i = 0; i < kDraws; ++i) {
    const auto chosen = lights.table.Choose(reference, random.Next());
    ASSERT_TRUE(chosen);
    ASSERT_NEAR(chosen->pmf / lights.table.ChoosePmf(reference, chosen->light), 1, 1e-5f);
    ++cells[static_cast<size_t>(chosen->light)].observed;
  }
  std::string text;
  EXPECT_GT(chi_square::PooledPValue(cells, text), 1e-4) << text;
}

// Sampling alone finds a light without extent: what the choice leaves out is lost.
TEST_P(LightChoice, EveryLightThatArrivesCanBeChosen) {
  const std::string spot = "LightSource \"spot\" \"point3 to\" [ 0.2 -1 0.3 ] ";
  const std::string slide = "LightSource \"projection\" \"string filename\" \"slide.pfm\" ";
  const std::string stretched = "Rotate 20 1 2 3 Scale 4 1 0.5 ";
  for (const std::string& light :
       {spot + "\"float coneangle\" 30", spot + "\"float coneangle\" 3 \"float conedeltaangle\" 20",
        spot + "\"float coneangle\" 100 \"float conedeltaangle\" 100",
        spot + "\"float coneangle\" 180 \"float conedeltaangle\" 180",
        stretched + spot + "\"float coneangle\" 30", slide + "\"float fov\" 100",
        slide + "\"float fov\" 179.9", stretched + slide + "\"float fov\" 50",
        stretched + "LightSource \"goniometric\" \"string filename\" \"slide.pfm\""}) {
    LightScene lights;
    lights.files.files["slide.pfm"] = Pfm({{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}}, 2);
    lights.Build("LightSource \"point\" \"point3 from\" [ 1 1 -1 ]\n" + light, {}, Sampler());
    ASSERT_EQ(lights.error, "");
    TestRandom random(3);
    int lit = 0, lost = 0;
    for (int i = 0; i < 20000; ++i) {
      const ReferencePoint reference = At(SampleUniformSphere(random.Next2<Point2>()) * 3);
      if (!lights.table.Sample(1, reference, {}, FourWavelengths(200))) continue;
      ++lit;
      if (!(lights.table.ChoosePmf(reference, 1) > 0)) ++lost;
    }
    EXPECT_EQ(lost, 0) << light;
    EXPECT_GT(lit, 100) << light;
  }
}

TEST_P(LightChoice, SingleLightIsChosenWithCertainty) {
  LightScene lights;
  lights.Build("LightSource \"infinite\" AreaLightSource \"diffuse\" Shape \"disk\"", {DiskShape(0, 1)},
               Sampler());
  ASSERT_EQ(lights.error, "");
  const auto chosen = lights.table.Choose(At({0, 0, 1}, {0, 0, 1}), 0.7f);
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->light, 1);
  EXPECT_EQ(chosen->pmf, 1);
  EXPECT_EQ(lights.table.ChoosePmf(At({0, 0, 1}, {0, 0, 1}), 1), 1);
}

TEST_P(LightChoice, NoLightIsChosenFromNone) {
  LightScene lights;
  lights.Build("", {}, Sampler());
  ASSERT_EQ(lights.error, "");
  EXPECT_TRUE(lights.table.empty());
  EXPECT_FALSE(lights.table.Choose(At({0, 0, 1}), 0.5f));
}

TEST_P(LightChoice, EstimateFromChosenLightsIsUnbiased) {
  LightScene lights;
  BuildMany(lights, Sampler());
  const ReferencePoint reference = At({0.5f, -1, 0}, {0, 0, 1});
  const SampledWavelengths wavelengths = FourWavelengths(200);
  double truth = 0;
  for (int light = 0; light < 44; ++light) {
    if (lights.table.ChoosePmf(reference, light) > 0) truth += Irradiance(lights.table, light, reference, 48);
  }
  TestRandom random(3);
  double estimate = 0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const auto chosen = lights.table.Choose(reference, (static_cast<float>(i) + random.Next()) / kDraws);
    ASSERT_TRUE(chosen);
    const auto sample = lights.table.Sample(chosen->light, reference, random.Next2<Point2>(), wavelengths);
    if (!sample) continue;
    estimate += static_cast<double>(sample->Radiance(wavelengths)[0]) * std::max(0.0f, sample->wi.z) /
                (sample->pdf * chosen->pmf);
  }
  // All lights have the same white, so one wavelength determines the luminance.
  const auto point = lights.table.Sample(0, reference, {}, wavelengths);
  const double ratio = static_cast<double>(SampleLuminance(lights.table, 0, reference, {})) / point->L[0];
  EXPECT_NEAR(estimate / kDraws * ratio / truth, 1, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Samplers, LightChoice, testing::ValuesIn(LightSamplers().Names()),
                         [](const auto& info) { return std::string(info.param); });

TEST(PowerChoice, ProbabilitiesAreProportionalToPower) {
  LightScene lights;
  lights.Build(R"(
    LightSource "point" "float power" 10
    LightSource "spot" "float power" 30
    AreaLightSource "diffuse" "float power" 60 "bool twosided" true
    Shape "disk")",
               {DiskShape(0, 3)}, LightSamplerKind::kPower);
  ASSERT_EQ(lights.error, "");
  const float expected[] = {0.1f, 0.3f, 0.6f};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(lights.table.ChoosePmf(At({0, 0, 1}), i), expected[i], 1e-3f);
}

TEST(TreeChoice, PrefersTheNearLight) {
  LightScene lights;
  lights.Build(R"(
    LightSource "point" "point3 from" [ 0 0 1 ]
    LightSource "point" "point3 from" [ 0 0 3 ])");
  ASSERT_EQ(lights.error, "");
  EXPECT_NEAR(lights.table.ChoosePmf(At({0, 0, 0}), 0), 0.9f, 1e-4f);
}

}  // namespace
}  // namespace tessera
