// What integrators report about a sample: the parts of its radiance and the surface that its camera ray sees.
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "renderer/integrator/estimator.h"
#include "tests/renderer/scene/built_world.h"

namespace tessera {
namespace {

// Keeps all that one path reports.
class Record : public SampleRecorder {
 public:
  struct Part {
    SampledSpectrum contribution;
    LightPath path;
  };
  struct Surface {
    Hit hit;
    SurfaceInteraction interaction;
    float distance = 0;
    SampledSpectrum albedo;
  };

  Record()
      : SampleRecorder({.surface = true, .albedo = true, .lobes = true, .shadow = true, .mirrored = true}) {}

  void Add(SampledSpectrum contribution, const LightPath& path) override {
    parts.push_back({contribution, path});
  }
  void AddFirstHit(const FirstHit& first) override {
    EXPECT_FALSE(surface) << "two first hits in one path";
    surface = Surface{first.hit, first.surface, first.distance, first.albedo};
  }
  void AddMirrored(const MirroredSurface& seen) override {
    EXPECT_TRUE(surface) << "which is in its mirror image";
    EXPECT_FALSE(mirrored) << "two surfaces in one mirror";
    mirrored = seen;
  }

  void AddShadow(SampledSpectrum blocked) override { shadow += blocked; }
  void Escape(SampledSpectrum transmittance) override {
    EXPECT_FALSE(escape) << "a path leaves the scene twice";
    escape = transmittance;
  }

  // The parts that arrived along such a path.
  SampledSpectrum Sum(int light, int depth, FirstScatter first) const {
    SampledSpectrum sum(0.0f);
    for (const Part& part : parts) {
      if (part.path.light == light && part.path.depth == depth && part.path.first.scatter == first)
        sum += part.contribution;
    }
    return sum;
  }

  std::vector<Part> parts;
  std::optional<Surface> surface;
  std::optional<MirroredSurface> mirrored;
  SampledSpectrum shadow{0.0f};
  std::optional<SampledSpectrum> escape;
};

constexpr IntegratorTraits kPath{IntegratorKind::kPath, false, true};

// Traces paths through one world.
class Tracer {
 public:
  Tracer(const World& world, IntegratorTraits integrator, int max_depth) : world_(world) {
    estimator_.integrator = integrator;
    estimator_.path.max_depth = max_depth;
    if (integrator.kind == IntegratorKind::kMixture) estimator_.lights.emplace(world);
  }

  // Sample `index` of the ray from the origin along d.
  SampledSpectrum Trace(Vec3 d, uint32_t index, Record* record) {
    Sampler sampler(IndependentSampler(0));
    sampler.StartSample(1, 2, index);
    wavelengths_ = SampledWavelengths::SampleVisible(sampler.Get1D());
    const PathContext context{world_, estimator_.path, wavelengths_, sampler, counts_};
    const Ray ray{{0, 0, 0}, Normalize(d)};
    return record == nullptr ? EstimateRadiance(context, estimator_, ray)
                             : EstimateRadiance(context, estimator_, ray, *record);
  }
  Record RecordOf(Vec3 d, uint32_t index = 0) {
    Record record;
    Trace(d, index, &record);
    return record;
  }

 private:
  const World& world_;
  Estimator estimator_;
  SampledWavelengths wavelengths_ = SampledWavelengths::SampleVisible(0.5f);
  RayCounts counts_;
};

void ExpectNear(SampledSpectrum actual, SampledSpectrum expected, float error) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(actual[i], expected[i], error) << "wavelength " << i;
}

TEST(SampleRecord, FirstHitOfASphereHasItsDistanceNormalAndIdentity) {
  const auto world = BuiltWorld(R"(
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "disk" "float radius" 9 "float height" 20
Material "conductor"
Translate 0 0 5
Shape "sphere" "float radius" 1
)");
  const Record record = Tracer(*world, kPath, 5).RecordOf({0, 0, 1});
  ASSERT_TRUE(record.surface);
  EXPECT_NEAR(record.surface->distance, 4, 1e-5f);
  EXPECT_NEAR(record.surface->interaction.p.z, 4, 1e-5f);
  EXPECT_NEAR(record.surface->interaction.n.z, -1, 1e-5f);
  EXPECT_EQ(record.surface->hit.shape, 1u);
  EXPECT_EQ(record.surface->hit.instance, Hit::kNoInstance);
  EXPECT_EQ(record.surface->interaction.material, world->geometry.shapes[1].surface.material);
}

TEST(SampleRecord, FirstHitOfAPatchHasItsTextureCoordinates) {
  const auto world = BuiltWorld(R"(
Shape "bilinearmesh" "point3 P" [ -2 -2 4  2 -2 4  -2 2 4  2 2 4 ]
)");
  const Record record = Tracer(*world, kPath, 5).RecordOf({0.25f, -0.25f, 1});
  ASSERT_TRUE(record.surface);
  EXPECT_NEAR(record.surface->interaction.uv.x, 0.75f, 1e-5f);
  EXPECT_NEAR(record.surface->interaction.uv.y, 0.25f, 1e-5f);
  EXPECT_NEAR(record.surface->distance, 4 * std::sqrt(1.125f), 1e-4f);
}

TEST(SampleRecord, FirstHitIsBeyondInterfaces) {
  const auto world = BuiltWorld(R"(
Shape "disk" "float radius" 9 "float height" 6
Material "interface"
Shape "disk" "float radius" 9 "float height" 2
)");
  for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kRandomWalk}) {
    const Record record = Tracer(*world, {kind}, 5).RecordOf({0, 0, 1});
    ASSERT_TRUE(record.surface);
    EXPECT_NEAR(record.surface->distance, 6, 1e-5f);
  }
}

TEST(SampleRecord, RayThatMissesEverythingHasNoFirstHit) {
  const auto world =
      BuiltWorld("LightSource \"infinite\"\nShape \"sphere\" \"float radius\" 0.5\nTranslate 0 0 -9");
  EXPECT_TRUE(Tracer(*world, kPath, 5).RecordOf({0, 0, 1}).surface);
  const auto empty =
      BuiltWorld("LightSource \"infinite\"\nTranslate 0 0 -9\nShape \"sphere\" \"float radius\" 0.5");
  const Record record = Tracer(*empty, kPath, 5).RecordOf({0, 0, 1});
  EXPECT_FALSE(record.surface);
  EXPECT_EQ(record.parts.size(), 1u);
}

TEST(SampleRecord, PathOfDepthZeroHasAFirstHit) {
  const auto world = BuiltWorld("Shape \"disk\" \"float radius\" 9 \"float height\" 3");
  EXPECT_TRUE(Tracer(*world, kPath, 0).RecordOf({0, 0, 1}).surface);
}

TEST(SampleRecord, AlbedoIsTheReflectanceOfADiffuseSurface) {
  const auto world = BuiltWorld(R"(
Material "diffuse" "spectrum reflectance" [ 300 0.3 900 0.3 ]
Shape "disk" "float radius" 9 "float height" 3
)");
  const Record record = Tracer(*world, kPath, 5).RecordOf({0.3f, 0, 1});
  ASSERT_TRUE(record.surface);
  ExpectNear(record.surface->albedo, SampledSpectrum(0.3f), 1e-5f);
}

TEST(SampleRecord, AlbedoOfClearGlassIsOne) {
  for (const char* roughness : {"0", "0.005"}) {
    const auto world = BuiltWorld(std::string("Material \"dielectric\" \"float roughness\" ") + roughness +
                                  "\nShape \"disk\" \"float radius\" 9 \"float height\" 3");
    const Record record = Tracer(*world, kPath, 5).RecordOf({0.3f, 0, 1});
    ASSERT_TRUE(record.surface);
    ExpectNear(record.surface->albedo, SampledSpectrum(1.0f), 0.02f);
  }
}

// On a convex surface under an even sky every path is known: it is reflected once, and escapes.
TEST(SampleRecord, LightOfTheSkyOnABallArrivesAtDepthOneWithTheScattererOfTheBall) {
  const std::string sky = "LightSource \"infinite\" \"spectrum L\" [ 300 1 900 1 ]\n";
  const std::string ball = "\nTranslate 0 0 5\nShape \"sphere\" \"float radius\" 1\n";
  const auto diffuse =
      BuiltWorld(sky + "Material \"diffuse\" \"spectrum reflectance\" [ 300 0.5 900 0.5 ]" + ball);
  const auto mirror =
      BuiltWorld(sky + "Material \"conductor\" \"spectrum reflectance\" [ 300 0.25 900 0.25 ]" + ball);
  for (uint32_t index = 0; index < 16; ++index) {
    const Vec3 d{0.05f, 0.03f, 1};
    const SampledSpectrum radiance =
        Tracer(*diffuse, kPath, 5).RecordOf({0, 1, 0}, index).Sum(0, 0, FirstScatter::kNone);
    EXPECT_GT(radiance[0], 0);
    ExpectNear(Tracer(*diffuse, kPath, 5).RecordOf(d, index).Sum(0, 1, FirstScatter::kReflection),
               radiance * 0.5f, 1e-5f);
    ExpectNear(Tracer(*mirror, kPath, 5).RecordOf(d, index).Sum(0, 1, FirstScatter::kReflection),
               radiance * 0.25f, 1e-4f);
  }
}

TEST(SampleRecord, EmitterThatTheCameraSeesContributesAtDepthZero) {
  const auto world = BuiltWorld(R"(
LightSource "point" "point3 from" [ 0 0 2 ] "rgb I" [ 100 100 100 ]
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Material "diffuse"
ReverseOrientation
Shape "disk" "float radius" 1 "float height" 4
)");
  int lit_by_point = 0;
  for (uint32_t index = 0; index < 50; ++index) {
    const Record record = Tracer(*world, kPath, 5).RecordOf({0, 0, 1}, index);
    EXPECT_GT(record.Sum(1, 0, FirstScatter::kNone)[0], 0);
    lit_by_point += AnyNonZero(record.Sum(0, 1, FirstScatter::kReflection));
    // A flat emitter does not light itself.
    EXPECT_FALSE(AnyNonZero(record.Sum(1, 1, FirstScatter::kReflection)));
  }
  EXPECT_GT(lit_by_point, 10);
}

struct Case {
  const char* name;
  IntegratorTraits integrator;
  const char* world;
};
constexpr Case kCases[] = {
    {"path", {IntegratorKind::kPath, false, true}, kHiddenLights},
    {"path under skies", {IntegratorKind::kPath, false, true}, kSkies},
    {"volpath", {IntegratorKind::kVolPath, true, true}, kSmoke},
    {"mixture", {IntegratorKind::kMixture, true, false}, kSmoke},
    {"simplepath", {IntegratorKind::kSimplePath, false, true}, kGlossyThings},
    {"simplevolpath", {IntegratorKind::kSimpleVolPath, true, false}, kSmoke},
    {"randomwalk", {IntegratorKind::kRandomWalk, false, false}, kSkies},
};

TEST(SampleRecord, RecordingLeavesTheRadianceUnchanged) {
  for (const Case& c : kCases) {
    const auto world = BuiltWorld(c.world, c.integrator.follows_media);
    Tracer tracer(*world, c.integrator, 6);
    int lit = 0;
    for (uint32_t index = 0; index < 200; ++index) {
      const Vec3 d{0.3f - 0.003f * static_cast<float>(index), -0.2f, 1};
      Record record;
      const SampledSpectrum recorded = tracer.Trace(d, index, &record);
      const SampledSpectrum alone = tracer.Trace(d, index, nullptr);
      for (int i = 0; i < 4; ++i) ASSERT_EQ(recorded[i], alone[i]) << c.name << ", sample " << index;
      lit += AnyNonZero(alone);
    }
    EXPECT_GT(lit, 20) << c.name;
  }
}

TEST(SampleRecord, PartsByLightDepthAndFirstScatterSumToTheRadiance) {
  for (const Case& c : kCases) {
    const auto world = BuiltWorld(c.world, c.integrator.follows_media);
    Tracer tracer(*world, c.integrator, 6);
    std::map<std::tuple<int, int, FirstScatter>, SampledSpectrum> sums;
    SampledSpectrum radiance(0.0f);
    for (uint32_t index = 0; index < 500; ++index) {
      Record record;
      radiance += tracer.Trace({0.3f - 0.001f * static_cast<float>(index), -0.2f, 1}, index, &record);
      for (const Record::Part& part : record.parts) {
        const LightPath& path = part.path;
        ASSERT_GE(path.light, LightPath::kMediumEmission);
        ASSERT_LT(path.light, static_cast<int>(world->lights.size()));
        ASSERT_LE(path.depth, 6);
        ASSERT_EQ(path.depth == 0, path.first.scatter == FirstScatter::kNone) << c.name;
        sums[{path.light, path.depth, path.first.scatter}] += part.contribution;
      }
    }
    EXPECT_GT(sums.size(), 3u) << c.name;
    SampledSpectrum total(0.0f);
    for (const auto& [key, sum] : sums) total += sum;
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(total[i], radiance[i], 1e-4f * radiance[i]) << c.name;
  }
}

TEST(SampleRecord, FogIsTheFirstScattererOfWhatItScattersAndOfWhatItsPathsFindLater) {
  const auto world = BuiltWorld(kSmoke, true);
  Tracer tracer(*world, {IntegratorKind::kVolPath, true, true}, 4);
  int by_fog = 0, glowing = 0;
  for (uint32_t index = 0; index < 300; ++index) {
    const Record record = tracer.RecordOf({-0.2f, 0, 1}, index);
    for (const Record::Part& part : record.parts) {
      if (part.path.first.scatter == FirstScatter::kMedium) {
        ++by_fog;
        // Fog scatters light into rays that pass it, too; only those that collide find light later.
        EXPECT_FALSE(record.surface && part.path.depth > 1)
            << "a path that scatters in a medium first has no first surface";
      }
      if (part.path.light == LightPath::kMediumEmission && part.path.depth == 0) ++glowing;
    }
  }
  EXPECT_GT(by_fog, 50);
  EXPECT_GT(glowing, 10);
}

}  // namespace
}  // namespace tessera
