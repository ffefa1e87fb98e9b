// Mattes (--aov crypto_object ...): their names, and what they cover, against one id per sample.
#include "renderer/scene/mattes.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/film/cryptomatte.h"
#include "renderer/film/picture_file.h"
#include "renderer/text/unicode.h"
#include "tests/renderer/scene/matte_scenes.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// The manifest of a layer as the header has it.
std::string ManifestOf(const Scene& scene, const std::string& layer) {
  for (const auto& [name, value] : scene.frame().attributes) {
    if (name.ends_with("/name") && value == layer)
      return scene.frame().attributes.at(name.substr(0, name.size() - 4) + "manifest");
  }
  return "none";
}

TEST_F(Mattes, AnIndependentReaderFindsTheCoverageOfOneIdPerSample) {
  const auto scene = LoadMattes(kMatteScene);
  const std::string picture =
      Write("picture.exr", *EncodeExr(scene->frame(), RenderMattes(*scene, kSamplesPerPixelMax)));
  const std::string samples = Write("samples.txt", EverySample(*scene));
  EXPECT_THAT(Python("cryptomatte.py", picture + " " + samples),
              HasSubstr("coverages agree with every sample"));
}

TEST_F(Mattes, AnIndependentReaderFindsTheNames) {
  const auto scene = LoadMattes(kMatteScene);
  const std::string picture =
      Write("picture.exr", *EncodeExr(scene->frame(), RenderMattes(*scene, kSamplesPerPixelMax)));
  EXPECT_EQ(Python("cryptomatte.py", picture),
            "CryptoObject: [\"floor\", \"Glasgefäß\", \"disk.1\", \"sphere.1\", \"leaves\", \"tree.1\", "
            "\"tree.2\"]\n"
            "CryptoMaterial: [\"white \\\"paint\\\"\", \"diffuse.1\", \"conductor.1\", \"dielectric.1\", "
            "\"diffuse.2\"]\n"
            "CryptoAsset: [\"set\\\\1\", \"Glasgefäß\", \"disk.1\", \"sphere.1\", \"tree\"]\n");
}

TEST_F(Mattes, OiiotoolReadsTheNames) {
  if (std::system("oiiotool --help >/dev/null 2>&1") != 0) GTEST_SKIP() << "needs oiiotool";
  const auto scene = LoadMattes(kMatteScene);
  const std::string picture =
      Write("picture.exr", *EncodeExr(scene->frame(), RenderMattes(*scene, kSamplesPerPixelMax)));
  const std::string info = (folder_ / "info.txt").string();
  ASSERT_EQ(std::system(fmt::format("oiiotool --info -v {} >{} 2>&1", picture, info).c_str()), 0);
  std::ifstream file(info);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  for (const char* each : {"CryptoObject00.R", "CryptoAsset02.A", "name: \"CryptoMaterial\"",
                           "conversion: \"uint32_to_float32\"", "floor", "7819c83c"})
    EXPECT_THAT(text, HasSubstr(each));
}

// The reader must not pass whatever it is given.
TEST_F(Mattes, TheIndependentReaderRefusesWrongCoveragesAndNames) {
  const auto scene = LoadMattes(kMatteScene);
  FramePicture picture = RenderMattes(*scene, kSamplesPerPixelMax);
  const std::string samples = Write("samples.txt", EverySample(*scene));
  const size_t middle = picture.values.size() / 2;
  const size_t coverage =
      middle - middle % picture.channels.size() +
      static_cast<size_t>(std::ranges::find(picture.channels, "CryptoObject00.G") - picture.channels.begin());
  picture.values[coverage] *= 1.001f;
  const std::string wrong = Write("wrong.exr", *EncodeExr(scene->frame(), picture));
  EXPECT_THAT(Python("cryptomatte.py", wrong + " " + samples), testing::StartsWith("failed: "));
  FrameSpec renamed = scene->frame();
  for (auto& [name, value] : renamed.attributes) {
    if (name.ends_with("manifest")) value.replace(value.find('"') + 1, 1, "X");
  }
  const std::string misnamed =
      Write("misnamed.exr", *EncodeExr(renamed, RenderMattes(*scene, kSamplesPerPixelMax)));
  EXPECT_THAT(Python("cryptomatte.py", misnamed), HasSubstr("has the id"));
}

TEST_F(Mattes, AnyCutOfTheSamplesGivesTheSameBits) {
  const auto scene = LoadMattes(kMatteScene);
  const FramePicture whole = RenderMattes(*scene, kSamplesPerPixelMax);
  for (const uint32_t unit : {1u, 4u}) EXPECT_TRUE(RenderMattes(*scene, unit).values == whole.values) << unit;
}

TEST_F(Mattes, ColoursHaveTheSameBitsWithAndWithoutMattes) {
  const FramePicture with = RenderMattes(*LoadMattes(kMatteScene), kSamplesPerPixelMax);
  const FramePicture without = RenderMattes(*LoadNamed(kMatteScene, {}), kSamplesPerPixelMax);
  for (const char* color : {"R", "G", "B"}) EXPECT_TRUE(with.Channel(color) == without.Channel(color));
}

TEST_F(Mattes, BeyondTheIdsOfAPixelTheWideOnesStayExactAndNothingIsInvented) {
  const auto scene = LoadNamed(StripsInOnePixel(3, 60), {"crypto_object"});
  const FramePicture picture = RenderMattes(*scene, kSamplesPerPixelMax);
  std::map<float, double> expected;
  for (const auto& [id, hits] : HitsByObject(*scene)) expected[id] = hits / 2048.0;
  ASSERT_EQ(expected.size(), 63u) << "more than a pixel holds";
  const auto value = [&](const std::string& channel) { return picture.Channel("CryptoObject" + channel)[0]; };
  EXPECT_NEAR(value("00.G"), expected[value("00.R")], 1e-6);
  EXPECT_NEAR(value("00.A"), expected[value("00.B")], 1e-6);
  EXPECT_NEAR(value("01.G"), expected[value("01.R")], 1e-6);
  EXPECT_GT(value("01.G"), 0.15);
  for (const char* narrow : {"01.", "02."}) {
    const double truth = expected[value(std::string(narrow) + "B")];
    EXPECT_GT(value(std::string(narrow) + "A"), 0);
    EXPECT_LE(value(std::string(narrow) + "A"), truth + 1e-6);
  }
  EXPECT_TRUE(RenderMattes(*scene, 16).values == picture.values) << "whatever was dropped, it is the same";
}

struct NameCase {
  const char* what;
  std::string world;
  const char* objects;
  const char* assets;
};

// The names alone, in order.
std::string Names(std::string manifest) {
  std::string names;
  for (size_t at = 1; at + 1 < manifest.size();) {
    const size_t end = manifest.find("\":\"", at);
    names += manifest.substr(at + 1, end - at - 1) + " ";
    at = end + 13;
  }
  return names;
}

TEST_F(Mattes, FollowTheRulesForNames) {
  const std::string sphere = "Shape \"sphere\" ",
                    curve = "Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 2 1 0 ] ";
  const std::string mesh = "Shape \"plymesh\" \"string filename\" \"geometry/wheel.v2.ply\" ";
  const NameCase cases[] = {
      {"numbers per kind", sphere + sphere + "Shape \"disk\" " + sphere, "sphere.1 sphere.2 disk.1 sphere.3 ",
       "sphere.1 sphere.2 disk.1 sphere.3 "},
      {"a name of its own, which the numbers skip", sphere + "\"string name\" \"moon\" " + sphere,
       "moon sphere.1 ", "moon sphere.1 "},
      {"several shapes of one name", "Attribute \"shape\" \"string name\" \"fur\" " + sphere + curve + sphere,
       "fur ", "fur "},
      {"an empty name is none", sphere + "\"string name\" \"\"", "sphere.1 ", "sphere.1 "},
      {"files without folder and endings", mesh + mesh, "wheel.1 wheel.2 ", "wheel.1 wheel.2 "},
      {"curves that follow each other", curve + curve + sphere + curve, "curve.1 sphere.1 curve.2 ",
       "curve.1 sphere.1 curve.2 "},
      {"instances",
       "ObjectBegin \"a\" " + sphere + sphere + "ObjectEnd ObjectInstance \"a\" ObjectInstance \"a\" ",
       "a.1 a.2 ", "a "},
      {"an asset of several shapes",
       sphere + "\"string asset\" \"car\" " + mesh + "\"string asset\" \"car\" ", "sphere.1 wheel.1 ",
       "car "},
      {"control characters", sphere + "\"string name\" \"a\\nb\x01\"", "a b  ", "a b  "},
      {"composed and decomposed spellings",
       sphere + "\"string name\" \"\xC3\xA9\" " + sphere + "\"string name\" \"e\xCC\x81\"", "\xC3\xA9 ",
       "\xC3\xA9 "},
  };
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const NameCase& each : cases) {
    const auto scene =
        LoadMattes("WorldBegin LightSource \"infinite\"\n" + each.world, {{"geometry/wheel.v2.ply", ply}});
    EXPECT_EQ(Names(ManifestOf(*scene, "CryptoObject")), each.objects) << each.what;
    EXPECT_EQ(Names(ManifestOf(*scene, "CryptoAsset")), each.assets) << each.what;
  }
}

TEST_F(Mattes, NamesDoNotDependOnWhatMoves) {
  const std::string still = "Shape \"sphere\" Shape \"sphere\" \"float radius\" 2 ";
  const std::string moving =
      "ActiveTransform EndTime Translate 1 0 0 ActiveTransform All Shape \"sphere\" "
      "ActiveTransform EndTime Translate -1 0 0 ActiveTransform All "
      "Shape \"sphere\" \"float radius\" 2 ";
  const auto a = LoadMattes("WorldBegin LightSource \"infinite\" " + still);
  const auto b = LoadMattes("WorldBegin LightSource \"infinite\" " + moving);
  EXPECT_EQ(ManifestOf(*a, "CryptoObject"), ManifestOf(*b, "CryptoObject"));
}

TEST_F(Mattes, LongNamesEndInTheirHash) {
  const std::string a = MatteName(std::string(500, 'x') + "a"), b = MatteName(std::string(500, 'x') + "b");
  EXPECT_LE(a.size(), kMatteNameBytesMax);
  EXPECT_NE(a, b);
  const std::string wide = MatteName(fmt::format("{:\u00e9<500}", ""));
  EXPECT_TRUE(IsUtf8(wide));
  EXPECT_EQ(MatteName(wide), wide);
  EXPECT_EQ(MatteName("a\xff\n"), "a\xEF\xBF\xBD ");
}

TEST_F(Mattes, WhatTheManifestHasNoRoomForIsReported) {
  std::string world = "WorldBegin LightSource \"infinite\"\n";
  for (int i = 0; i < 600; ++i)
    world += fmt::format("Shape \"sphere\" \"string name\" \"{}{}\"\n", std::string(200, 'n'), i);
  const auto scene = LoadMattes(world);
  EXPECT_THAT(scene->summary().warnings, testing::Contains(HasSubstr("names of the others")).Times(0));
  EXPECT_THAT(scene->summary().warnings,
              testing::Contains(testing::AllOf(HasSubstr("of 600 objects"), HasSubstr("60000 bytes"))));
  for (const auto& [name, value] : scene->frame().attributes)
    EXPECT_LE(name.size() + value.size(), kAttributeSizeMax) << name;
}

TEST_F(Mattes, NameThatIsNoStringIsRefused) {
  EXPECT_THROW(LoadMattes("WorldBegin LightSource \"infinite\" Shape \"sphere\" \"float name\" 1"),
               std::runtime_error);
  EXPECT_THROW(
      LoadNamed("WorldBegin LightSource \"infinite\" Shape \"sphere\" \"string name\" [ \"a\" \"b\" ]", {}),
      std::runtime_error);
}

}  // namespace
}  // namespace tessera
