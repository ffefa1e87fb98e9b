// All estimators must converge to the same picture: a t-test on differences between independent batches of
// samples, per tile and channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"
#include "tests/renderer/scene/estimator_scenes.h"

namespace tessera {
namespace {

constexpr int kBatches = 64;
constexpr uint32_t kBatchSamples = 32;  // per pixel
constexpr int kSize = 8, kTile = 4;     // pixels
// The probability that |t| with 63 degrees of freedom exceeds this is 1e-7. With about 600 comparisons
// (tiles, channels, estimators and scenes) a correct renderer fails one run in 15,000 (Bonferroni).
constexpr double kTMax = 6.0;

Result<std::unique_ptr<Scene>> Load(const std::string& text, const RenderOptions& options = {}) {
  MemoryFiles files({{"scene.pbrt", text}, {"sky.pfm", BrightTexelMap()}});
  return Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
}

RenderOptions With(const std::string& integrator) {
  RenderOptions options;
  options.integrator = integrator;
  return options;
}

// Per batch: the mean radiance of each tile and channel, then that of the whole picture.
struct Batches {
  static constexpr int kTiles = (kSize / kTile) * (kSize / kTile);
  static constexpr int kValues = kTiles * 3 + 1;
  double values[kBatches][kValues] = {};

  double Mean(int value) const {
    double sum = 0;
    for (const auto& batch : values) sum += batch[value];
    return sum / kBatches;
  }
};

std::unique_ptr<Batches> RenderBatches(const std::string& text) {
  const Result<std::unique_ptr<Scene>> scene = Load(text);
  EXPECT_TRUE(scene.has_value()) << scene.error().message;
  auto batches = std::make_unique<Batches>();
  if (!scene) return batches;
  RenderStatistics statistics;
  for (uint32_t b = 0; b < kBatches; ++b) {
    const SampleRange range{b * kBatchSamples, kBatchSamples};
    const RadianceTile tile = *(*scene)->Render({0, 0, kSize, kSize}, {}, range, nullptr, &statistics);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        for (int c = 0; c < 3; ++c) {
          const double mean = tile.sums[static_cast<size_t>((y * kSize + x) * 4 + c)] / kBatchSamples;
          const int place = (y / kTile) * (kSize / kTile) + x / kTile;
          batches->values[b][place * 3 + c] += mean / (kTile * kTile);
          batches->values[b][Batches::kValues - 1] += mean / (kSize * kSize * 3);
        }
      }
    }
  }
  EXPECT_EQ(statistics.discarded_samples, 0u);
  return batches;
}

struct Comparison {
  double t = 0;               // of the mean difference
  double standard_error = 0;  // of the mean difference, relative to the mean
};

Comparison Compare(const Batches& a, const Batches& b, int value) {
  double sum = 0, sum_squares = 0;
  for (int i = 0; i < kBatches; ++i) {
    const double difference = a.values[i][value] - b.values[i][value];
    sum += difference;
    sum_squares += difference * difference;
  }
  const double mean = sum / kBatches;
  const double variance = (sum_squares / kBatches - mean * mean) / (kBatches - 1);
  const double standard_error = std::sqrt(std::max(variance, 0.0));
  return {standard_error > 0 ? mean / standard_error : 0, standard_error / b.Mean(value)};
}

// Renders `world` with each estimator and expects the means of `reference`. `error_max`: the maximum relative
// standard error of the comparison of whole pictures, which then detects errors six times as large.
void ExpectAgreement(const char* world, std::initializer_list<const char*> estimators, int max_depth,
                     double error_max, const char* reference = "\"path\"") {
  const auto expected = RenderBatches(SceneHead(reference, max_depth) + world);
  ASSERT_GT(expected->Mean(Batches::kValues - 1), 0.05);
  for (const char* estimator : estimators) {
    const auto batches = RenderBatches(SceneHead(estimator, max_depth) + world);
    for (int value = 0; value < Batches::kValues; ++value) {
      const Comparison comparison = Compare(*batches, *expected, value);
      EXPECT_LT(std::abs(comparison.t), kTMax) << estimator << ", value " << value << ": "
                                               << batches->Mean(value) << " not " << expected->Mean(value);
      if (value == Batches::kValues - 1) {
        EXPECT_LT(comparison.standard_error, error_max) << estimator;
      }
    }
  }
}

constexpr const char* kLightsOnly = "\"simplepath\" \"bool samplebsdf\" false";
constexpr const char* kBsdfOnly = "\"simplepath\" \"bool samplelights\" false";
constexpr const char* kUniformOnly = "\"simplepath\" \"bool samplelights\" false \"bool samplebsdf\" false";

TEST(Estimators, AgreeInADiffuseBox) {
  ExpectAgreement(kDiffuseBox,
                  {"\"mixture\"", "\"simplepath\"", kLightsOnly, kBsdfOnly, kUniformOnly, "\"randomwalk\"",
                   "\"simplevolpath\"", "\"volpath\""},
                  4, 0.02);
}

TEST(Estimators, AgreeWhereLightsHideLights) {
  for (const char* chooser : {"uniform", "power", "bvh"}) {
    const std::string mixture = std::string("\"mixture\" \"string lightsampler\" \"") + chooser + "\"";
    ExpectAgreement(kHiddenLights, {mixture.c_str()}, 3, 0.01);
  }
  ExpectAgreement(kHiddenLights, {"\"simplepath\"", kBsdfOnly, "\"randomwalk\""}, 3, 0.02);
}

TEST(Estimators, AgreeOnGlossyAndSpecularSurfaces) {
  ExpectAgreement(kGlossyThings, {"\"mixture\"", "\"simplepath\"", kBsdfOnly}, 5, 0.02);
}

TEST(Estimators, AgreeOnLightsThatMirrorsShowToDarkSurfaces) {
  ExpectAgreement(kMirrorOverADarkFloor, {"\"simplepath\"", kBsdfOnly, "\"volpath\""}, 5, 0.05);
}

// A path brings at most 0.02 of the lamp's radiance from the floor. One of those that roulette leaves, with
// 0.006 of it by way of the mirror, would bring a quarter instead.
TEST(Estimators, MakeNoBrightPixelsOfLightsThatMirrorsShowToDarkSurfaces) {
  for (const char* estimator : {"\"path\"", "\"volpath\""}) {
    const auto scene = Load(SceneHead(estimator, 5) + kMirrorOverADarkFloor);
    ASSERT_TRUE(scene) << scene.error().message;
    RenderStatistics statistics;
    float most = 0;
    for (uint32_t sample = 0; sample < 2048; ++sample) {
      const RadianceTile tile =
          *(*scene)->Render({0, kSize / 2, kSize, kSize}, {}, {sample, 1}, nullptr, &statistics);
      for (size_t pixel = 0; pixel < tile.sums.size() / 4; ++pixel)
        most = std::max(most, tile.sums[pixel * 4 + 1]);
    }
    EXPECT_GT(most, 0.5f) << estimator;
    EXPECT_LT(most, 8) << estimator;
  }
}

TEST(Estimators, AgreeOnLightsThatIlluminateSomeObjects) {
  ExpectAgreement(kLinkedLights,
                  {"\"mixture\"", "\"simplepath\"", kBsdfOnly, "\"simplevolpath\"", "\"volpath\""}, 4, 0.02);
}

TEST(Estimators, AgreeOnObjectsThatAreHiddenFromSomeRays) {
  ExpectAgreement(kHiddenObjects,
                  {"\"mixture\"", "\"simplepath\"", kBsdfOnly, "\"simplevolpath\"", "\"volpath\""}, 4, 0.02);
}

TEST(Estimators, AgreeOnWhatCastsNoShadows) {
  ExpectAgreement(kNoShadows, {"\"simplepath\"", kLightsOnly, "\"volpath\""}, 4, 0.02);
}

TEST(Estimators, AgreeUnderSkies) {
  ExpectAgreement(kSkies, {"\"mixture\"", "\"simplepath\"", kBsdfOnly}, 3, 0.01);
}

TEST(Estimators, AgreeOnLightThatComesInThroughAPortal) {
  const std::string sky = R"(Rotate 30 1 2 3 LightSource "infinite" "string filename" "sky.pfm")";
  const std::string world =
      std::string("AttributeBegin ") + sky + kWindow + "AttributeEnd" + kRoomWithAWindow +
      R"(AreaLightSource "diffuse" Translate 0 1.7 3 Shape "sphere" "float radius" 0.1)";
  ExpectAgreement(world.c_str(), {"\"mixture\"", "\"simplepath\"", kBsdfOnly, "\"volpath\""}, 3, 0.02);
}

TEST(Estimators, FindTheSameLightThroughAWindowWithAndWithoutAPortal) {
  const std::string sky = R"(LightSource "infinite" "rgb L" [ 5 4 3 ])";
  const auto open = RenderBatches(SceneHead("\"path\"", 3) + sky + kRoomWithAWindow);
  const auto portal = RenderBatches(SceneHead("\"path\"", 3) + sky + kWindow + kRoomWithAWindow);
  ASSERT_GT(open->Mean(Batches::kValues - 1), 0.02);
  for (int value = 0; value < Batches::kValues; ++value) {
    const Comparison comparison = Compare(*portal, *open, value);
    EXPECT_LT(std::abs(comparison.t), kTMax)
        << "value " << value << ": " << portal->Mean(value) << " not " << open->Mean(value);
  }
  EXPECT_LT(Compare(*portal, *open, Batches::kValues - 1).standard_error, 0.02);
}

TEST(Estimators, AgreeInsideALamp) {
  ExpectAgreement(kInsideALamp, {"\"mixture\"", "\"simplepath\"", kBsdfOnly, "\"randomwalk\""}, 4, 0.02);
}

TEST(Estimators, AgreeInSmokeAndFog) {
  ExpectAgreement(kSmoke, {"\"mixture\"", "\"simplevolpath\""}, 5, 0.02, "\"volpath\"");
}

TEST(Estimators, AgreeOnLampsInFog) {
  ExpectAgreement(kLampsInFog, {"\"mixture\"", "\"simplevolpath\""}, 4, 0.03, "\"volpath\"");
}

TEST(Estimators, AgreeInARoomThatIsLitThroughAGap) {
  ExpectAgreement(kRoomLitThroughAGap, {"\"mixture\"", "\"simplevolpath\""}, 5, 0.05, "\"volpath\"");
}

TEST(Estimators, MixtureTracesNoShadowRays) {
  for (const char* estimator : {"\"mixture\"", "\"randomwalk\"", "\"simplevolpath\"", kBsdfOnly}) {
    const auto scene = Load(SceneHead(estimator, 3) + kDiffuseBox);
    ASSERT_TRUE(scene) << scene.error().message;
    RenderStatistics statistics;
    (void)(*scene)->Render({0, 0, kSize, kSize}, {}, {0, 16}, nullptr, &statistics);
    EXPECT_EQ(statistics.shadow_rays, 0u) << estimator;
    EXPECT_EQ(statistics.camera_rays, 16u * kSize * kSize) << estimator;
    EXPECT_GT(statistics.bounce_rays, statistics.camera_rays / 4) << estimator;
  }
}

TEST(Estimators, MixtureRefusesLightsThatNoRayCanHit) {
  const Result<std::unique_ptr<Scene>> point =
      Load("WorldBegin\nLightSource \"infinite\"\nLightSource \"spot\"\n", With("mixture"));
  ASSERT_FALSE(point);
  EXPECT_EQ(point.error().message,
            "scene.pbrt:3:1: no ray can hit light \"spot\", and this integrator traces no shadow rays; use "
            "\"path\"");
  const Result<std::unique_ptr<Scene>> hidden =
      Load("WorldBegin\nAreaLightSource \"diffuse\"\nShape \"disk\" \"float alpha\" 0\n", With("mixture"));
  ASSERT_FALSE(hidden);
  EXPECT_EQ(hidden.error().message,
            "scene.pbrt:2:1: no ray can hit the area light of a shape of alpha 0, and this integrator traces "
            "no shadow rays; use \"path\"");
  const std::string passed =
      "WorldBegin\nAreaLightSource \"diffuse\"\nShape \"disk\" \"bool visible_indirect\" false\n";
  const Result<std::unique_ptr<Scene>> refused = Load(passed, With("mixture"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(
      refused.error().message,
      "scene.pbrt:2:1: no scattered ray can hit the area light of a shape with \"visible_indirect\" false, "
      "and this integrator traces no shadow rays; use \"path\"");
  EXPECT_TRUE(Load(passed, With("path")));
}

TEST(Estimators, SkiesAroundAMediumWithoutABorderGiveAWarning) {
  const std::string medium =
      "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nMediumInterface \"\" \"fog\"\nCamera "
      "\"perspective\"\nWorldBegin\nLightSource \"infinite\"\nMediumInterface \"fog\" ";
  const auto warnings = [&](const std::string& outside, const char* integrator) {
    const auto scene = Load(medium + outside + "\nShape \"sphere\"\n", With(integrator));
    EXPECT_TRUE(scene) << scene.error().message;
    return (*scene)->summary().warnings;
  };
  EXPECT_THAT(
      warnings("\"fog\"", "volpath"),
      testing::ElementsAre(testing::StartsWith("scene.pbrt:3:1: the medium of the camera has no border")));
  EXPECT_THAT(warnings("\"\"", "volpath"), testing::IsEmpty());
  for (const std::string& warning : warnings("\"fog\"", "path"))
    EXPECT_THAT(warning, testing::Not(testing::HasSubstr("border")));
}

TEST(Estimators, LightsThatStayDarkGiveAWarning) {
  const Result<std::unique_ptr<Scene>> scene =
      Load("Integrator \"simplepath\" \"bool samplelights\" false\nWorldBegin\nLightSource \"point\"\n");
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ((*scene)->summary().warnings.size(), 1u);
  EXPECT_EQ((*scene)->summary().warnings[0],
            "scene.pbrt:3:1: no ray can hit light \"point\", and this integrator traces no shadow rays: it "
            "has no effect");
}

TEST(Estimators, OptionOverridesTheIntegratorOfTheScene) {
  for (const char* name : {"path", "volpath", "mixture", "simplepath", "simplevolpath", "randomwalk"}) {
    const auto scene = Load(SceneHead("\"path\"", 3) + kDiffuseBox, With(name));
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ((*scene)->summary().integrator, name);
  }
  const auto wrong = Load(SceneHead("\"path\"", 3) + kDiffuseBox, With("mixtur"));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message, "--integrator: unknown integrator \"mixtur\" (did you mean \"mixture\"?)");
}

}  // namespace
}  // namespace tessera
