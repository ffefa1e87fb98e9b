// Mattes (--aov crypto_object ...): their names, and what they cover, against one id per sample.
#include "renderer/scene/mattes.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "renderer/film/cryptomatte.h"
#include "renderer/film/merge_rules.h"
#include "renderer/film/merger.h"
#include "renderer/film/picture_file.h"
#include "renderer/scene/scene.h"
#include "renderer/text/unicode.h"
#include "tests/build_paths.h"
#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr const char* kMatteLayers[] = {"CryptoObject", "CryptoMaterial", "CryptoAsset"};
// Their ids are sets in the order of the frame's channels.
constexpr size_t kMatteCount = std::size(kMatteLayers);

// Things that are blurred by motion and lens, have holes, are instanced, and whose names need escapes.
constexpr const char* kMatteScene = R"(
LookAt 0 2 -8  0 0.5 0  0 1 0
Camera "perspective" "float fov" 45 "float lensradius" 0.15 "float focaldistance" 8 "float shutterclose" 1
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
PixelFilter "mitchell"
Sampler "zsobol" "integer pixelsamples" 32
WorldBegin
LightSource "infinite"
MakeNamedMaterial "white \"paint\"" "string type" "diffuse"
Texture "holes" "float" "checkerboard" "float uscale" 8 "float vscale" 8 "float tex1" 0 "float tex2" 1
ObjectBegin "tree"
  Material "diffuse" Shape "sphere" "float radius" 0.6
  Material "conductor" Shape "sphere" "float radius" 0.3 "string name" "leaves"
ObjectEnd
NamedMaterial "white \"paint\""
Shape "trianglemesh" "point3 P" [ -9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9 ] "integer indices" [ 0 1 2 0 2 3 ]
  "string name" "floor" "string asset" "set\\1"
Material "dielectric" Shape "sphere" "string name" "Glasgefäß"
AttributeBegin
  Translate -3 0 0 ActiveTransform EndTime Translate 0.5 0 0 ActiveTransform All ObjectInstance "tree"
AttributeEnd
AttributeBegin Translate 3 0 1 ObjectInstance "tree" AttributeEnd
AttributeBegin Translate 1.6 1 -2 Material "diffuse" Shape "disk" "texture alpha" "holes" AttributeEnd
AttributeBegin
  Translate -1 2 2 ActiveTransform EndTime Translate 0 0.5 0 ActiveTransform All Shape "sphere" "float radius" 0.7
AttributeEnd
)";

std::unique_ptr<Scene> LoadNamed(const std::string& text, std::set<std::string> layers,
                                 std::map<std::string, std::string> files = {}) {
  files["scene.pbrt"] = text;
  MemoryFiles source(std::move(files));
  RenderOptions options;
  options.aovs = std::move(layers);
  options.exr_type = ExrType::kFloat;
  auto scene = Scene::Load(source, "scene.pbrt", options, Scene::Depth::kRender);
  if (!scene) throw std::runtime_error(scene.error().message);
  return std::move(*scene);
}

std::unique_ptr<Scene> LoadMattes(const std::string& text, std::map<std::string, std::string> files = {}) {
  return LoadNamed(text, {"crypto_object", "crypto_material", "crypto_asset"}, std::move(files));
}

// Renders the frame in units of at most `unit` samples.
FramePicture RenderMattes(const Scene& scene, uint32_t unit) {
  Merger merger(scene.frame());
  for (int tile = 0; tile < scene.frame().TileCount(); ++tile) {
    for (uint32_t begin = 0; begin < scene.frame().samples_per_pixel;) {
      SampleRange range{begin, DyadicSizeMax(begin, scene.frame().samples_per_pixel)};
      while (range.size > unit) range = range.Left();
      EXPECT_TRUE(merger.Add(tile, *scene.Render(scene.frame().TileBounds(tile), {}, range, nullptr)));
      begin = range.end();
    }
  }
  EXPECT_TRUE(merger.Complete());
  return merger.Picture();
}

// The manifest of a layer as the header has it.
std::string ManifestOf(const Scene& scene, const std::string& layer) {
  for (const auto& [name, value] : scene.frame().attributes) {
    if (name.ends_with("/name") && value == layer)
      return scene.frame().attributes.at(name.substr(0, name.size() - 4) + "manifest");
  }
  return "none";
}

// What brute force knows: a line per sample with its filter weight and what it hit.
std::string EverySample(const Scene& scene) {
  const FrameSpec& frame = scene.frame();
  const ChannelLayout layout = frame.Layout();
  std::string text;
  for (uint32_t s = 0; s < frame.samples_per_pixel; ++s) {
    const RadianceTile tile = *scene.Render(frame.crop, {}, {s, 1}, nullptr);
    const auto pixels = static_cast<size_t>(frame.crop.area());
    IdReader ids(layout.shape(), pixels, tile.sums);
    for (size_t p = 0; p < pixels; ++p) {
      const float* record = &tile.sums[p * layout.shape().stride()];
      const auto width = static_cast<size_t>(frame.crop.width());
      text += fmt::format("{} {} {}", p % width, p / width, record[layout.weight()]);
      for (size_t set = 0; set < kMatteCount; ++set) {
        for (const IdWeight& hit : ids.Next(record[layout.shape().stride() - kMatteCount + set])) {
          EXPECT_EQ(hit.weight, record[layout.weight()]);
          text += fmt::format(" {}={:08x}", kMatteLayers[set], std::bit_cast<uint32_t>(hit.id));
        }
      }
      text += "\n";
    }
  }
  return text;
}

class Mattes : public testing::Test {
 protected:
  Mattes() {
    std::string name = (std::filesystem::temp_directory_path() / "mattes-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    folder_ = name;
  }
  ~Mattes() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  // Runs a script of tests/picture with the standard library of Python alone. Returns its output, or what it
  // complains about after "failed: ".
  std::string Python(const std::string& script, const std::string& arguments) const {
    const std::string log = (folder_ / "log").string();
    const int code = std::system(
        fmt::format("python3 -B {}/tests/picture/{} {} >{} 2>&1", SourceDir(), script, arguments, log)
            .c_str());
    std::ifstream file(log);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    return (code == 0 ? "" : "failed: ") + text;
  }

  std::filesystem::path folder_;
};

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

// A pixel of three wide and sixty narrow strips.
std::string StripsInOnePixel() {
  std::string text = R"(
Camera "orthographic"
Film "rgb" "integer xresolution" 1 "integer yresolution" 1
PixelFilter "box"
Sampler "independent" "integer pixelsamples" 2048
WorldBegin
LightSource "infinite"
)";
  float left = -1;
  for (int i = 0; i < 63; ++i) {
    const float right = left + (i < 3 ? 2 * 0.2f : 2 * 0.4f / 60);
    text += fmt::format("Shape \"bilinearmesh\" \"point3 P\" [ {0} -1 1 {1} -1 1 {0} 1 1 {1} 1 1 ]\n", left,
                        right);
    left = right;
  }
  return text;
}

TEST_F(Mattes, BeyondTheIdsOfAPixelTheWideOnesStayExactAndNothingIsInvented) {
  const auto scene = LoadNamed(StripsInOnePixel(), {"crypto_object"});
  const FramePicture picture = RenderMattes(*scene, kSamplesPerPixelMax);
  std::map<float, double> expected;
  for (uint32_t s = 0; s < 2048; ++s) {
    const RadianceTile tile = *scene->Render(scene->frame().crop, {}, {s, 1}, nullptr);
    expected[tile.sums[tile.sums.size() - 2]] += 1.0 / 2048;
  }
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
