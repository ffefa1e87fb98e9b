// Paths that are followed together yield what each yields alone, to the last bit.
#include "renderer/integrator/path_batch.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <map>
#include <string>
#include <vector>

#include "tests/renderer/scene/built_world.h"

namespace tessera {
namespace {

// A closed room of triangles, some with normals, with boxes in it.
constexpr const char* kRoomOfTriangles = R"(
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -2 -2 -1  2 -2 -1  2 -2 5  -2 -2 5 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 2 -1  2 2 -1  2 2 5  -2 2 5 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "diffuse" "rgb reflectance" [ 0.7 0.2 0.1 ]
Shape "trianglemesh" "point3 P" [ -2 -2 -1  -2 -2 5  -2 2 5  -2 2 -1 ] "integer indices" [ 0 1 2 0 2 3 ]
  "normal N" [ 1 0.2 0  1 0 0.2  1 -0.2 0  1 0 -0.2 ]
Material "diffuse" "spectrum reflectance" [ 400 0.2 600 0.8 ]
Shape "trianglemesh" "point3 P" [ 2 -2 -1  2 -2 5  2 2 5  2 2 -1 ] "integer indices" [ 0 1 2 0 2 3 ]
  "normal N" [ -1 0.2 0  -1 0 0.2  -1 -0.2 0  -1 0 -0.2 ]
AttributeBegin
  ReverseOrientation
  Shape "trianglemesh" "point3 P" [ -2 -2 5  2 -2 5  2 2 5  -2 2 5 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "trianglemesh" "point3 P" [ -2 -2 -1  2 -2 -1  2 2 -1  -2 2 -1 ] "integer indices" [ 0 1 2 0 2 3 ]
)";

constexpr const char* kSmallLamp = R"(
Material "diffuse" "rgb reflectance" [ 0.3 0.3 0.3 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 40 30 20 ]
  Shape "trianglemesh" "point3 P" [ -0.3 1.9 2  0.3 1.9 2  0.3 1.9 2.5  -0.3 1.9 2.5 ]
    "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
)";

std::string Wall(const std::string& material) {
  return material + R"(
Shape "trianglemesh" "point3 P" [ -1 -1.5 3  1 -1.5 3.4  1 0.9 3.6  -1 0.9 3.2 ]
  "integer indices" [ 0 1 2 0 2 3 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
)";
}

// The world with what PathBatch needs.
struct Batched {
  std::unique_ptr<World> world;
  Estimator estimator;

  Batched(const std::string& scene, int max_depth) : world(BuiltWorld(scene)) {
    estimator.integrator = {IntegratorKind::kPath, false, true};
    estimator.path.max_depth = max_depth;
    estimator.plain = std::make_unique<const PlainSurfaces>(*world);
    estimator.visibility = std::make_unique<LightVisibility>(*world);
  }
};

// A path by its number.
Ray CameraRay(uint32_t number, Sampler& sampler, SampledWavelengths* wavelengths) {
  sampler.StartSample(static_cast<int>(number % 7), 3, number / 7);
  *wavelengths = SampledWavelengths::SampleVisible(sampler.Get1D());
  const Point2 u = sampler.Get2D();
  return {{0, 0, 0}, Normalize(Vec3{2.6f * u.x - 1.3f, 2.6f * u.y - 1.3f, 1})};
}

struct PathResult {
  SampledSpectrum radiance;
  SampledWavelengths wavelengths;
  float next_number = 0;  // what the sampler gives after the path

  void ExpectEqual(const PathResult& other, uint32_t number) const {
    for (int i = 0; i < 4; ++i) {
      ASSERT_EQ(std::bit_cast<uint32_t>(radiance[i]), std::bit_cast<uint32_t>(other.radiance[i])) << number;
      ASSERT_EQ(wavelengths.pdf[i], other.wavelengths.pdf[i]) << number;
    }
    ASSERT_EQ(next_number, other.next_number) << number;
  }
};

constexpr uint32_t kPaths = 3000;

std::vector<PathResult> FollowAlone(const Batched& scene, RayCounts& counts) {
  std::vector<PathResult> results(kPaths);
  Sampler sampler(SobolSampler(5, Randomization::kFastOwen));
  for (uint32_t i = 0; i < kPaths; ++i) {
    SampledWavelengths wavelengths;
    const Ray ray = CameraRay(i, sampler, &wavelengths);
    const PathContext context{*scene.world, scene.estimator.path, wavelengths, sampler, counts};
    results[i].radiance = EstimateRadiance(context, scene.estimator, ray);
    results[i].wavelengths = wavelengths;
    results[i].next_number = sampler.Get1D();
  }
  return results;
}

std::vector<PathResult> FollowTogether(const Batched& scene, RayCounts& counts) {
  std::vector<PathResult> results(kPaths);
  PathBatch batch(*scene.world, scene.estimator, Sampler(SobolSampler(5, Randomization::kFastOwen)), counts);
  uint32_t started = 0, ended = 0;
  uint32_t numbers[kLanes];
  while (ended < kPaths) {
    ForEachLane(batch.free_lanes(), [&](int lane) {
      if (started == kPaths) return;
      numbers[lane] = started;
      batch.Start(lane, CameraRay(started++, batch.sampler(lane), &batch.wavelengths(lane)));
    });
    ForEachLane(batch.Extend(), [&](int lane) {
      results[numbers[lane]] = {batch.radiance(lane), batch.wavelengths(lane), batch.sampler(lane).Get1D()};
      ++ended;
    });
  }
  return results;
}

void ExpectSamePaths(const std::string& text, int max_depth = 6) {
  const Batched scene(text, max_depth);
  ASSERT_TRUE(PathBatch::Follows(*scene.world, scene.estimator));
  RayCounts counts, counts_together;
  const std::vector<PathResult> alone = FollowAlone(scene, counts);
  const std::vector<PathResult> together = FollowTogether(scene, counts_together);
  float total = 0;
  for (uint32_t i = 0; i < kPaths; ++i) {
    together[i].ExpectEqual(alone[i], i);
    if (testing::Test::HasFatalFailure()) return;
    total += Sum(alone[i].radiance);
  }
  EXPECT_GT(total, 0) << "the scene is dark";
  EXPECT_EQ(counts.camera, counts_together.camera);
  EXPECT_EQ(counts.bounce, counts_together.bounce);
  EXPECT_EQ(counts.shadow, counts_together.shadow);
}

TEST(PathBatch, PathsOnPlainSurfacesAreThoseOfOneByOne) {
  for (const int depth : {0, 1, 2, 5, 40}) ExpectSamePaths(std::string(kRoomOfTriangles) + kSmallLamp, depth);
}

TEST(PathBatch, EveryKindOfLightIsSampledAsOneByOne) {
  const std::map<std::string, std::string> lights = {
      {"large rectangle", R"(AttributeBegin AreaLightSource "diffuse" "rgb L" [ 6 5 4 ] "bool twosided" true
Shape "trianglemesh" "point3 P" [ -1 0 1  1 0 1  1 0.2 4  -1 0.2 4 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd)"},
      {"two rectangles",
       std::string(kSmallLamp) + R"(AttributeBegin AreaLightSource "diffuse" "rgb L" [ 1 2 9 ]
Shape "trianglemesh" "point3 P" [ -1.9 0 1  -1.9 1 1  -1.9 1 2  -1.9 0 2 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd)"},
      {"triangle", R"(AttributeBegin AreaLightSource "diffuse" "rgb L" [ 6 5 4 ] "bool twosided" true
Shape "trianglemesh" "point3 P" [ -1 1 1  1 1 1  1 1.2 4 ] "integer indices" [ 0 1 2 ] AttributeEnd)"},
      {"sphere", R"(AttributeBegin AreaLightSource "diffuse" "rgb L" [ 6 5 4 ] Translate 0 1 2
Shape "sphere" "float radius" 0.3 AttributeEnd)"},
      {"point", R"(LightSource "point" "rgb I" [ 3 2 1 ] "point3 from" [ 0.5 1 2 ])"},
      {"hidden lamp", R"(AttributeBegin AreaLightSource "diffuse" "rgb L" [ 60 50 40 ]
Shape "trianglemesh" "point3 P" [ -0.3 1.9 2  0.3 1.9 2  0.3 1.9 2.5  -0.3 1.9 2.5 ]
"integer indices" [ 0 1 2 0 2 3 ] "float alpha" 0 AttributeEnd)"},
  };
  for (const auto& [name, light] : lights) {
    SCOPED_TRACE(name);
    ExpectSamePaths(std::string(kRoomOfTriangles) + light);
  }
}

TEST(PathBatch, SkiesAreSampledAsOneByOne) {
  const std::string floor = R"(
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -2 -1 -1  2 -1 -1  2 -1.2 5  -2 -1 5 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
  ExpectSamePaths("LightSource \"infinite\" \"string filename\" \"sky.pfm\"\n" + floor + Wall(""));
  ExpectSamePaths("LightSource \"infinite\" \"rgb L\" [ 1 2 3 ]\n" + floor + Wall(""));
  ExpectSamePaths("LightSource \"distant\" \"rgb L\" [ 1 2 3 ] \"point3 from\" [ 1 3 -2 ]\n" + floor +
                  Wall(""));
}

TEST(PathBatch, PathsOverOtherSurfacesAreThoseOfOneByOne) {
  const std::map<std::string, std::string> walls = {
      {"glass", Wall("Material \"dielectric\"")},
      {"dispersion", Wall("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"")},
      {"mirror", Wall("Material \"conductor\" \"float roughness\" 0")},
      {"metal", Wall("Material \"conductor\" \"float roughness\" 0.1")},
      {"coat", Wall("Material \"coateddiffuse\" \"float roughness\" 0.05")},
      {"texture", Wall("Texture \"checks\" \"spectrum\" \"checkerboard\"\nMaterial \"diffuse\" \"texture "
                       "reflectance\" \"checks\"")},
      {"alpha", Wall("Material \"diffuse\"") + " \"float alpha\" 0.5"},
      {"interface", Wall("Material \"interface\"")},
      {"sphere", "Translate 0 0 3\nShape \"sphere\" \"float radius\" 0.7"},
      {"instance", "ObjectBegin \"o\"\n" + Wall("Material \"diffuse\"") +
                       "ObjectEnd\nAttributeBegin Translate 0.3 0 0.2 Rotate 10 0 1 0 ObjectInstance \"o\" "
                       "AttributeEnd"},
      {"edges", R"(Material "diffuse"
Shape "trianglemesh" "point3 P" [ 0 0 2  0 0 2  1 1 3  0 0 0.5  1e-20 0 0.5  0 1e-20 0.5 ]
"integer indices" [ 0 1 2 3 4 5 ])"},
  };
  for (const auto& [name, wall] : walls) {
    SCOPED_TRACE(name);
    ExpectSamePaths(std::string(kRoomOfTriangles) + kSmallLamp + wall, 12);
  }
}

TEST(PathBatch, RaysBehindAWallThatHidesAllLightSampleLightsSeldomAsOneByOne) {
  ExpectSamePaths(
      std::string(kRoomOfTriangles) + kSmallLamp + R"(Material "diffuse" "rgb reflectance" [ 0.8 0.8 0.8 ]
Shape "trianglemesh" "point3 P" [ -2 -2 1.5  1.9 -2 1.5  1.9 2 1.5  -2 2 1.5 ] "integer indices" [ 0 1 2 0 2 3 ]
)",
      20);
}

TEST(PathBatch, DoesNotFollowWhatItCannot) {
  Batched scene(std::string(kRoomOfTriangles) + kSmallLamp, 5);
  EXPECT_TRUE(PathBatch::Follows(*scene.world, scene.estimator));
  scene.estimator.path.force_diffuse = true;
  EXPECT_FALSE(PathBatch::Follows(*scene.world, scene.estimator));
  scene.estimator.path.force_diffuse = false;
  scene.estimator.integrator.kind = IntegratorKind::kMixture;
  EXPECT_FALSE(PathBatch::Follows(*scene.world, scene.estimator));
  scene.estimator.integrator.kind = IntegratorKind::kVolPath;
  EXPECT_TRUE(PathBatch::Follows(*scene.world, scene.estimator));
  scene.world->has_subsurface = true;
  EXPECT_FALSE(PathBatch::Follows(*scene.world, scene.estimator));
  const Batched balls("LightSource \"infinite\"\nShape \"sphere\"", 5);
  EXPECT_FALSE(PathBatch::Follows(*balls.world, balls.estimator)) << "no surface is plain";
}

TEST(PathBatch, IsIdleWithoutPaths) {
  const Batched scene(std::string(kRoomOfTriangles) + kSmallLamp, 5);
  RayCounts counts;
  PathBatch batch(*scene.world, scene.estimator, Sampler(IndependentSampler(0)), counts);
  EXPECT_EQ(batch.free_lanes(), kAllLanes);
  EXPECT_EQ(batch.Extend(), 0u);
  EXPECT_EQ(counts.camera, 0u);
}

}  // namespace
}  // namespace tessera
