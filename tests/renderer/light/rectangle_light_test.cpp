#include "renderer/light/rectangle_emitter.h"
#include "renderer/shape/spherical_sampling.h"
#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

constexpr char kEmitter[] = "AreaLightSource \"diffuse\" \"rgb L\" [ 2 2 2 ] \"bool twosided\" ";
const std::vector<uint32_t> kHalves = {0, 1, 2, 0, 2, 3};

// Tilted, 3 by 2, its plane 2 from the origin.
std::vector<Point3> Corners() {
  const Vec3 ex = Normalize(Vec3{1, 0.5f, 0.25f}) * 3, across = Normalize(Cross(ex, {0, 0, 1})) * 2;
  const Point3 corner{-1.25f, 0.5f, 2.5f};
  return {corner, corner + ex, corner + ex + across, corner + across};
}

void BuildMesh(LightScene& lights, std::vector<Point3> corners, std::vector<uint32_t> indices = kHalves,
               const std::string& two_sided = "true") {
  lights.Build(kEmitter + two_sided + " Shape \"trianglemesh\"",
               {MeshShape(std::move(corners), std::move(indices))});
  ASSERT_EQ(lights.error, "");
  ASSERT_EQ(lights.table.size(), 2u);
}

// Whether light 0 stands for both triangles.
bool IsOneLight(const LightTable& table, const ReferencePoint& reference) {
  const float first = table.ChoosePmf(reference, 0), second = table.ChoosePmf(reference, 1);
  return first == 1 && second == 1;
}

TEST(RectangleLight, TwoTrianglesAreChosenAsOneLight) {
  const std::vector<Point3> corners = Corners();
  const std::vector<std::vector<uint32_t>> orders = {
      {0, 1, 2, 0, 2, 3}, {1, 2, 0, 3, 0, 2}, {2, 0, 1, 2, 3, 0}, {1, 2, 3, 3, 0, 1}};
  for (const auto& order : orders) {
    LightScene lights;
    BuildMesh(lights, corners, order);
    EXPECT_TRUE(IsOneLight(lights.table, At({0, 0, 0}, {0, 0, 1})));
    const auto chosen = lights.table.Choose(At({0, 0, 0}, {0, 0, 1}), 0.9f);
    ASSERT_TRUE(chosen);
    EXPECT_EQ(chosen->light, 0);
    EXPECT_EQ(chosen->pmf, 1);
  }
}

TEST(RectangleLight, VerticesThatAreNotSharedButEqualAreOneEdge) {
  const std::vector<Point3> c = Corners();
  LightScene lights;
  BuildMesh(lights, {c[0], c[1], c[2], c[0], c[2], c[3]}, {0, 1, 2, 3, 4, 5});
  EXPECT_TRUE(IsOneLight(lights.table, At({0, 0, 0}, {0, 0, 1})));
}

TEST(RectangleLight, OtherPairsOfTrianglesStayTwoLights) {
  const std::vector<Point3> c = Corners();
  const Vec3 bend = (c[1] - c[0]) * 0.01f, fold{0, 0, 0.02f};
  const std::vector<std::vector<Point3>> others = {
      {c[0], c[1], c[2] + bend, c[3]},         // no parallelogram
      {c[0], c[1], c[2] + bend, c[3] + bend},  // no right angles
      {c[0], c[1], c[2], c[3] + fold},         // not plane
  };
  for (const auto& corners : others) {
    LightScene lights;
    BuildMesh(lights, corners);
    EXPECT_FALSE(IsOneLight(lights.table, At({0, 0, 0}, {0, 0, 1})));
  }
  LightScene turned, apart;
  BuildMesh(turned, c, {0, 1, 2, 0, 3, 2});  // normals on different sides
  EXPECT_FALSE(IsOneLight(turned.table, At({0, 0, 0}, {0, 0, 1})));
  BuildMesh(apart, {c[0], c[1], c[2], c[0] + fold, c[2] + fold, c[3] + fold}, {0, 1, 2, 3, 4, 5});
  EXPECT_FALSE(IsOneLight(apart.table, At({0, 0, 0}, {0, 0, 1})));
}

TEST(RectangleLight, TrianglesWithAPictureStayTwoLights) {
  LightScene lights;
  lights.files.files["screen.pfm"] = Pfm({{0, 0, 0}, {1, 1, 1}}, 2);
  lights.Build(R"(AreaLightSource "diffuse" "string filename" "screen.pfm" Shape "trianglemesh")",
               {MeshShape(Corners(), kHalves)});
  ASSERT_EQ(lights.error, "");
  EXPECT_FALSE(IsOneLight(lights.table, At({0, 0, 0}, {0, 0, 1})));
}

Point3 CenterOf(const std::vector<Point3>& corners) {
  return (corners[0] + corners[2]) * 0.5f;
}
Normal3 NormalOf(const std::vector<Point3>& corners) {
  return Normalize(Cross(corners[1] - corners[0], corners[3] - corners[0]));
}

// The mean over stratified samples of light 0 of what `value` makes of each.
template <typename Value>
double MeanOfSamples(const LightTable& table, const ReferencePoint& reference, const Value& value) {
  constexpr int kSide = 200;
  double sum = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Point2 u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                   (static_cast<float>(i / kSide) + 0.5f) / kSide};
    const auto sample = table.Sample(0, reference, u, FourWavelengths(0));
    EXPECT_TRUE(sample);
    if (sample) sum += static_cast<double>(value(*sample));
  }
  return sum / (kSide * kSide);
}

// Irradiance from a polygon of radiance 1 above the horizon (Lambert's formula).
float Lambert(const std::vector<Point3>& corners, Point3 from, Normal3 n) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = Normalize(corners[i] - from), b = Normalize(corners[(i + 1) % corners.size()] - from);
    sum += std::acos(Dot(a, b)) * Dot(n, Normalize(Cross(a, b)));
  }
  return static_cast<float>(std::abs(sum)) / 2;
}

TEST(RectangleLight, GivesTheIrradianceOfLambertsFormula) {
  const std::vector<Point3> corners = Corners();
  LightScene lights;
  BuildMesh(lights, corners);
  const Point3 center = CenterOf(corners);
  const Normal3 n = NormalOf(corners);
  // Near, far enough to be sampled by area, and on the other side.
  for (const float distance : {0.05f, 1.0f, 5.0f, 150.0f, -2.0f}) {
    const ReferencePoint reference = At(center - n * distance, distance > 0 ? n : -n);
    const float expected = 2 * Lambert(corners, reference.p, reference.n);
    EXPECT_NEAR(Irradiance(lights.table, 0, reference, 64) / expected, 1, 2e-3f) << distance;
  }
}

TEST(RectangleLight, PdfOfAHitOnEitherTriangleIsThatOfTheSample) {
  LightScene lights;
  BuildMesh(lights, Corners());
  TestRandom random(1);
  for (const ReferencePoint& reference :
       {At({0, 0, 0}, {0, 0, 1}), At({0, 0, 0}), At({0.5f, 1, 2}, {0, 1, 0}), At({0, 0, -200}, {0, 0, 1})}) {
    for (int i = 0; i < 500; ++i) {
      const auto sample = lights.table.Sample(0, reference, random.Next2<Point2>(), FourWavelengths(0));
      ASSERT_TRUE(sample);
      SurfaceInteraction hit;
      hit.p = sample->p;
      hit.n = sample->n;
      for (const int light : {0, 1})
        EXPECT_NEAR(lights.table.AreaLightPdf(light, reference, sample->wi, hit) / sample->pdf, 1, 2e-3f);
    }
  }
}

// Directions by their density: the solid angle is the mean of 1 / pdf over the samples.
TEST(RectangleLight, DensityIntegratesToOneOverItsSolidAngle) {
  const std::vector<Point3> c = Corners();
  LightScene lights;
  BuildMesh(lights, c);
  for (const ReferencePoint& reference :
       {At({0, 0, 0}, {0, 0, 1}), At({0, 0, 0}), At({1, 1, 1}, {1, 0, 0})}) {
    const double mean =
        MeanOfSamples(lights.table, reference, [](const LightSample& sample) { return 1 / sample.pdf; });
    const auto corner = [&](int index) { return Double3(c[index] - reference.p); };
    const float solid_angle =
        SolidAngle(corner(0), corner(1), corner(2)) + SolidAngle(corner(0), corner(2), corner(3));
    EXPECT_NEAR(mean / solid_angle, 1, 2e-3);
  }
}

// The variance of one sample of the irradiance, relative to the square of the mean.
TEST(RectangleLight, SamplesFollowWhatArrivesAtAllDistances) {
  const std::vector<Point3> corners = Corners();
  LightScene lights;
  BuildMesh(lights, corners);
  const Point3 center = CenterOf(corners);
  const Normal3 n = NormalOf(corners);
  const Vec3 aside = Normalize(corners[1] - corners[0]);
  const float radius = Length(corners[2] - corners[0]) / 2;
  for (const float distance : {0.5f, 1.3f, 1.45f, 2.0f, 10.0f}) {
    for (const float tilt : {0.0f, 0.8f}) {
      const ReferencePoint reference = At(center - Normalize(n + tilt * aside) * (distance * radius), n);
      const auto arriving = [&](const LightSample& sample) { return AbsDot(sample.wi, n) / sample.pdf; };
      const double mean = MeanOfSamples(lights.table, reference, arriving);
      const double mean_square = MeanOfSamples(
          lights.table, reference, [&](const LightSample& sample) { return Sqr(arriving(sample)); });
      EXPECT_LT(mean_square / (mean * mean) - 1, 0.06) << distance << " " << tilt;
    }
  }
}

TEST(RectangleLight, IsNotSampledFromItsPlaneNorFromBehind) {
  const std::vector<Point3> corners = Corners();
  LightScene lights;
  BuildMesh(lights, corners, kHalves, "false");
  const Normal3 n = NormalOf(corners);
  const Point2 u{0.3f, 0.6f};
  const Point3 beside = corners[0] - (corners[1] - corners[0]);
  EXPECT_FALSE(lights.table.Sample(0, At(beside, n), u, FourWavelengths(0)));
  EXPECT_TRUE(lights.table.Sample(0, At(beside + n * 0.1f, n), u, FourWavelengths(0)));
  EXPECT_FALSE(lights.table.Sample(0, At(beside - n * 0.1f, n), u, FourWavelengths(0)));
}

// The same samples for the points of several lanes.
TEST(RectangleLight, SamplesOfLanesHaveTheBitsOfOneSample) {
  for (const bool two_sided : {false, true}) {
    LightScene lights;
    BuildMesh(lights, Corners(), kHalves, two_sided ? "true" : "false");
    const std::optional<RectangleLight> rectangle = lights.table.RectangleOf(0);
    ASSERT_TRUE(rectangle);
    TestRandom random(3);
    int far = 0, seen = 0;
    for (int round = 0; round < 2000; ++round) {
      std::array<ReferencePoint, kLanes> references;
      std::array<Point2, kLanes> u;
      std::array<std::array<float, kLanes>, 11> values;
      for (int lane = 0; lane < kLanes; ++lane) {
        ReferencePoint& reference = references[lane];
        const auto any = [&] {
          return Vec3{random.Next(), random.Next(), random.Next()} - Vec3{0.5f, 0.5f, 0.5f};
        };
        reference = At(any() * 16, Normalize(any()));
        reference.p_error = Abs(any()) * 1e-6f;
        u[lane] = random.Next2<Point2>();
        const Vec3 parts[] = {reference.p, reference.p_error, reference.shading_n};
        for (size_t i = 0; i < 9; ++i) values[i][lane] = parts[i / 3][static_cast<int>(i % 3)];
        values[9][lane] = u[lane].x;
        values[10][lane] = u[lane].y;
      }
      const auto load = [&](size_t i) { return Float8::Load(values[i].data()); };
      SurfacePoints8 points;
      points.p = {load(0), load(1), load(2)};
      points.p_error = {load(3), load(4), load(5)};
      points.n = points.shading_n = {load(6), load(7), load(8)};
      const RectangleSamples8 samples = rectangle->emitter->SampleFar(points, {load(9), load(10)}, two_sided);
      std::array<float, kLanes> x, y, z, pdf;
      samples.p.x.Store(x.data());
      samples.p.y.Store(y.data());
      samples.p.z.Store(z.data());
      samples.pdf.Store(pdf.data());
      ForEachLane(samples.far, [&](int lane) {
        const std::optional<ShapeSample> expected =
            rectangle->emitter->Sample(references[lane], u[lane], two_sided);
        ASSERT_EQ(HasLane(samples.seen, lane), expected.has_value());
        if (!expected) return;
        EXPECT_EQ(expected->p, (Point3{x[lane], y[lane], z[lane]}));
        EXPECT_EQ(expected->p_error, rectangle->emitter->p_error());
        EXPECT_EQ(expected->n, rectangle->emitter->n());
        EXPECT_EQ(expected->pdf, pdf[lane]);
      });
      far += std::popcount(samples.far);
      seen += std::popcount(samples.seen);
      if (HasFailure()) return;
    }
    EXPECT_GT(far, 2000 * kLanes * 3 / 4);
    EXPECT_LT(far, 2000 * kLanes);
    EXPECT_GT(seen, 2000 * kLanes / 4);
    EXPECT_EQ(rectangle->two_sided, two_sided);
  }
}

}  // namespace
}  // namespace tessera
