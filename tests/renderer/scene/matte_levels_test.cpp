// How many ids of a pixel a picture with mattes has (--cryptomatte-levels).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <vector>

#include "renderer/film/picture_file.h"
#include "tests/renderer/scene/matte_scenes.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const std::set<std::string> kAllMattes{"crypto_object", "crypto_material", "crypto_asset"};

class MatteLevels : public Mattes {};

TEST_F(MatteLevels, AnIndependentReaderFindsTheLevelsAndTheCoverageOfEverySample) {
  std::string text;
  for (const uint32_t levels : {1u, 6u, kCryptomatteLevelsMax}) {
    const auto scene = LoadNamed(kMatteScene, kAllMattes, {}, levels);
    EXPECT_EQ(scene->frame().cryptomatte_levels, levels);
    const std::string picture =
        Write("picture.exr", *EncodeExr(scene->frame(), RenderMattes(*scene, kSamplesPerPixelMax)));
    if (text.empty()) text = EverySample(*scene);
    EXPECT_THAT(Python("cryptomatte.py", picture + " " + Write("samples.txt", text)),
                HasSubstr("coverages agree with every sample"))
        << levels;
  }
}

// The mattes add up to the largest coverages that there is room for, and so to alpha if there is room for
// all.
TEST_F(MatteLevels, AddUpToAlphaOnlyIfThereAreEnoughForTheIdsOfAPixel) {
  constexpr int kStrips = 14;
  std::vector<uint32_t> hits;
  for (const auto& [levels, short_pixels] : {std::pair(1u, 1), std::pair(6u, 1), std::pair(7u, 0)}) {
    const auto scene = LoadNamed(StripsInOnePixel(0, kStrips), {"alpha", "crypto_object"}, {}, levels);
    if (hits.empty()) {
      for (const auto& [id, count] : HitsByObject(*scene)) hits.push_back(count);
      ASSERT_EQ(hits.size(), size_t{kStrips});
      std::ranges::sort(hits, std::greater());
    }
    const FramePicture picture = RenderMattes(*scene, kSamplesPerPixelMax);
    double sum = 0;
    for (uint32_t level = 0; level < levels; ++level) {
      sum += picture.Channel(fmt::format("CryptoObject{:02}.G", level))[0];
      sum += picture.Channel(fmt::format("CryptoObject{:02}.A", level))[0];
    }
    const auto room = static_cast<std::ptrdiff_t>(2 * levels);
    EXPECT_NEAR(sum, std::accumulate(hits.begin(), hits.begin() + room, 0.0) / 2048, 1e-6) << levels;
    const std::string file = Write("picture.exr", *EncodeExr(scene->frame(), picture));
    EXPECT_THAT(Python("cryptomatte.py", file + " --levels"),
                HasSubstr(fmt::format("CryptoObject: {} levels, {} of 1 pixels short of alpha", levels,
                                      short_pixels)));
  }
}

// A pixel keeps 32 ids, of which the largest levels write 16.
TEST_F(MatteLevels, TheLargestNumberHasIdsOfWholeWeightInAPixelOf32) {
  const auto scene = LoadNamed(StripsInOnePixel(0, 32), {"crypto_object"}, {}, kCryptomatteLevelsMax);
  const FramePicture picture = RenderMattes(*scene, kSamplesPerPixelMax);
  std::map<float, uint32_t> hits = HitsByObject(*scene);
  ASSERT_EQ(hits.size(), size_t{kIdsPerPixelMax});
  for (uint32_t level = 0; level < kCryptomatteLevelsMax; ++level) {
    for (const auto& [id, coverage] : {std::pair("R", "G"), std::pair("B", "A")}) {
      const auto value = [&](const char* channel) {
        return picture.Channel(fmt::format("CryptoObject{:02}.{}", level, channel))[0];
      };
      EXPECT_NEAR(value(coverage), hits[value(id)] / 2048.0, 1e-6) << level << id;
      hits.erase(value(id));
    }
  }
  EXPECT_EQ(hits.size(), kIdsPerPixelMax - 16) << "no id is written twice";
}

TEST_F(MatteLevels, ChangeNothingElseOfAPicture) {
  const auto few = LoadNamed(kMatteScene, kAllMattes, {}, 1);
  const auto usual = LoadNamed(kMatteScene, kAllMattes);
  EXPECT_EQ(usual->frame().cryptomatte_levels, 3u);
  EXPECT_EQ(few->frame().channels, usual->frame().channels);
  EXPECT_EQ(few->frame().attributes, usual->frame().attributes);
  const FramePicture a = RenderMattes(*few, kSamplesPerPixelMax),
                     b = RenderMattes(*usual, kSamplesPerPixelMax);
  for (const std::string& channel : a.channels)
    EXPECT_TRUE(a.Channel(channel) == b.Channel(channel)) << channel;
  EXPECT_EQ(b.channels.size() - a.channels.size(), 3u * 2 * 4);
}

std::string WithFilm(const std::string& parameters) {
  return "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 " + parameters +
         "\nWorldBegin LightSource \"infinite\" Shape \"sphere\"\n";
}

TEST_F(MatteLevels, AreAParameterOfFilmThatTheCommandLineOverrides) {
  const std::string scene = WithFilm("\"string layers\" \"crypto_asset\" \"integer cryptomattelevels\" 5");
  EXPECT_EQ(LoadNamed(scene, {})->frame().cryptomatte_levels, 5u);
  EXPECT_EQ(LoadNamed(scene, {}, {}, 2)->frame().cryptomatte_levels, 2u);
  EXPECT_THAT(LoadNamed(scene, {})->summary().warnings, testing::IsEmpty());
}

TEST_F(MatteLevels, OfAPictureWithoutMattesAreAWarningAndTheFrameIsThatOfTheDefault) {
  const auto scene = LoadNamed(WithFilm(""), {"albedo"}, {}, 5);
  EXPECT_EQ(scene->frame(), LoadNamed(WithFilm(""), {"albedo"})->frame());
  EXPECT_THAT(scene->summary().warnings,
              testing::Contains(HasSubstr("the number of Cryptomatte levels has no effect")));
}

TEST_F(MatteLevels, BeyondTheirLimitsAreRefusedWithTheirPlace) {
  for (const int levels : {0, -1, 9, 2'000'000'000}) {
    MemoryFiles files({{"scene.pbrt", WithFilm(fmt::format("\"integer cryptomattelevels\" {}", levels))}});
    const auto refused = Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kCheck);
    ASSERT_FALSE(refused) << levels;
    EXPECT_THAT(refused.error().message,
                HasSubstr(fmt::format("cryptomattelevels must lie between 1 and 8, not {}", levels)));
  }
  RenderOptions options;
  for (const uint32_t levels : {0u, 9u, 0xffffffffu}) {
    options.cryptomatte_levels = levels;
    MemoryFiles files({{"scene.pbrt", WithFilm("")}});
    const auto refused = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kCheck);
    ASSERT_FALSE(refused) << levels;
    EXPECT_THAT(refused.error().message, HasSubstr("--cryptomatte-levels: must lie between 1 and 8"));
  }
}

}  // namespace
}  // namespace tessera
