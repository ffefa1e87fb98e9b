#include "proto/scene_package.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "proto/terms.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const std::string kDigest(64, 'a');

TEST(ScenePackage, SurvivesItsManifest) {
  ScenePackage package;
  package.files["scene.pbrt"] = {Sha256("x"), 1};
  package.files["textures/wood and stone.png"] = {Sha256("y"), kBlobBytesMax};
  const auto decoded = DecodeScenePackage(EncodeScenePackage(package));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(*decoded, package);
  EXPECT_EQ(*DecodeScenePackage(EncodeScenePackage({})), ScenePackage{});
}

TEST(ScenePackage, PathsCannotLeaveThePackage) {
  for (const char* good : {"a", "a/b.c", "..a/b..", "a b/ä.png", ".hidden"})
    EXPECT_TRUE(IsPackagePath(good)) << good;
  for (const char* bad :
       {"", "/a", "a/", "a//b", ".", "..", "../a", "a/../b", "a/..", "./a", "a/.", "a\nb", "a\\b", "a\x7f"}) {
    EXPECT_FALSE(IsPackagePath(bad)) << bad;
  }
  EXPECT_FALSE(IsPackagePath(std::string(kPathBytesMax + 1, 'a')));
  EXPECT_TRUE(IsPackagePath(std::string(kPathBytesMax, 'a')));
}

TEST(ScenePackage, RefusesManifestsItWouldNotWrite) {
  const std::string first = "tessera-package 1\n";
  const struct {
    std::string manifest, error;
  } table[] = {
      {"", "manifest:1"},
      {"tessera-package 2\n", "manifest:1"},
      {first + kDigest + " 1 a", "manifest:2: truncated"},
      {first + kDigest.substr(1) + " 1 a\n", "manifest:2"},
      {first + "g" + kDigest.substr(1) + " 1 a\n", "64 hexadecimal digits"},
      {first + kDigest + " x a\n", "size"},
      {first + kDigest + " -1 a\n", "size"},
      {first + kDigest + " 1\n", "size"},
      {first + kDigest + " 99999999999999999999 a\n", "size"},
      {first + kDigest + " 18446744073709551615 a\n", "limit"},
      {first + kDigest + " 1 ../a\n", "path"},
      {first + kDigest + " 1 /etc/passwd\n", "path"},
      {first + kDigest + " 01 a\n", "canonical"},
      {first + kDigest + " 1 b\n" + kDigest + " 1 a\n", "canonical"},
      {first + kDigest + " 1 a\n" + kDigest + " 1 a\n", "canonical"},
      {first + std::string(64, 'A') + " 1 a\n", "canonical"},
  };
  for (const auto& [manifest, error] : table) {
    const auto decoded = DecodeScenePackage(manifest);
    ASSERT_FALSE(decoded) << manifest;
    EXPECT_THAT(decoded.error().message, HasSubstr(error)) << manifest;
  }
}

TEST(ScenePackage, WhateverAManifestHoldsNoPathLeavesThePackage) {
  // Pieces of paths that mean something, put together at random; the same every time.
  const std::string pieces[] = {"/",  "..", ".",  "a",   "\\", "%2e", std::string(1, '\0'),
                                "\n", " ",  "b/", "../", "~"};
  uint64_t state = 1;
  int accepted = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string path;
    for (int length = static_cast<int>(state >> 60); length >= 0; --length) {
      state = state * 6364136223846793005 + 1442695040888963407;
      path += pieces[(state >> 33) % std::size(pieces)];
    }
    const auto decoded = DecodeScenePackage("tessera-package 1\n" + kDigest + " 1 " + path + "\n");
    if (!decoded) continue;
    ++accepted;
    ASSERT_EQ(decoded->files.size(), 1u);
    const std::string& kept = decoded->files.begin()->first;
    ASSERT_TRUE(IsPackagePath(kept)) << kept;
    ASSERT_NE(kept.front(), '/');
    ASSERT_EQ(("/" + kept + "/").find("/../"), std::string::npos) << kept;
    ASSERT_EQ(kept.find('\0'), std::string::npos);
  }
  EXPECT_GT(accepted, 100) << "the test must meet good paths too";
}

TEST(SceneKey, TellsApartWhateverDiffers) {
  const Digest a = Sha256("a"), b = Sha256("b");
  FrameSpec frame;
  frame.width = frame.height = 8;
  frame.crop = {0, 0, 8, 8};
  frame.samples_per_pixel = 4;
  frame.attributes = {{"sampler", "sobol"}};
  const Digest key = SceneKey(a, "file", "options", frame);
  EXPECT_EQ(key, SceneKey(a, "file", "options", frame));
  EXPECT_NE(key, SceneKey(b, "file", "options", frame));
  EXPECT_NE(key, SceneKey(a, "fil", "eoptions", frame));
  EXPECT_NE(key, SceneKey(a, "file", "option", frame));
}

TEST(SceneKey, CoversEverySettingOfTheFrame) {
  FrameSpec frame;
  frame.attributes = {{"sampler", "sobol"}};
  std::set<Digest> keys;
  const auto add = [&](const auto& change) {
    FrameSpec changed = frame;
    change(changed);
    keys.insert(SceneKey({}, "file", "", changed));
  };
  add([](FrameSpec&) {});
  add([](FrameSpec& f) { f.width = 7; });
  add([](FrameSpec& f) { f.height = 7; });
  add([](FrameSpec& f) { f.crop.x0 = 7; });
  add([](FrameSpec& f) { f.crop.y0 = 7; });
  add([](FrameSpec& f) { f.crop.x1 = 7; });
  add([](FrameSpec& f) { f.crop.y1 = 7; });
  add([](FrameSpec& f) { f.samples_per_pixel = 7; });
  add([](FrameSpec& f) { f.tile_size = 7; });
  add([](FrameSpec& f) { f.exr_type = ExrType::kFloat; });
  add([](FrameSpec& f) { f.noise_threshold = 0.5; });
  add([](FrameSpec& f) { f.denoiser = Denoiser::kRegression; });
  add([](FrameSpec& f) { f.cryptomatte_levels = 5; });
  add([](FrameSpec& f) { f.channels.pop_back(); });
  add([](FrameSpec& f) { f.channels[0].name = "X"; });
  add([](FrameSpec& f) { f.channels[0].type = ChannelType::kFloat; });
  add([](FrameSpec& f) { f.channels[0].rule = MergeRule::kNearest; });
  add([](FrameSpec& f) { f.channels[0].is_written = false; });
  add([](FrameSpec& f) { f.attributes["sampler"] = "halton"; });
  add([](FrameSpec& f) { f.attributes = {{"samplers", "obol"}}; });
  add([](FrameSpec& f) { f.attributes["more"] = ""; });
  EXPECT_EQ(keys.size(), 21u);
}

}  // namespace
}  // namespace tessera
