// Damaged scenes: no bytes may do worse than an error that names its place.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/renderer/pbrt/parse_helpers.h"

namespace tessera {
namespace {

const char* const kSeeds[] = {
    R"(LookAt 3 4 1.5  .5 .5 0  0 0 1
Camera "perspective" "float fov" 45
Sampler "halton" "integer pixelsamples" [ 128 ]
ColorSpace "rec2020"
Film "rgb" "string filename" "simple.png" "integer xresolution" [400] "integer yresolution" [400]
Option "disable-pixel-jitter" true
TransformTimes 0 1
WorldBegin
LightSource "infinite" "rgb L" [ .4 .45 .5 ]
AttributeBegin
  Attribute "material" "rgb reflectance" [ .1 .2 .3 ]
  Material "dielectric" "spectrum eta" "glass-BK7"
  ActiveTransform EndTime Translate 0 .25 0 ActiveTransform All
  Shape "sphere" "float radius" 1 # a comment
AttributeEnd
)",
    R"(Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1 ]
CoordinateSystem "here"
MakeNamedMedium "fog" "string type" "homogeneous" "spectrum sigma_a" [ 300 .1 800 .2 ]
MediumInterface "" "fog"
WorldBegin
CoordSysTransform "here"
Texture "checks" "spectrum" "checkerboard" "float uscale" [16] "rgb tex1" [.1 .1 .1]
MakeNamedMaterial "floor" "string type" "diffuse" "texture reflectance" "checks"
ObjectBegin "tree"
  NamedMaterial "floor"
  ReverseOrientation
  Shape "trianglemesh" "integer indices" [0 1 2 0 3 1] "point3 P" [ -20 -20 0 20 -20 0 20 20 0 -20 20 0 ]
ObjectEnd
Rotate 135 1 0 0 Scale 2 2 2 ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]
ObjectInstance "tree"
Include "part.pbrt"
Import "part.pbrt"
TransformBegin AreaLightSource "diffuse" "blackbody L" 6500 "bool twosided" true Shape "disk" TransformEnd
)"};

const char* const kPieces[] = {"\"",
                               "[",
                               "]",
                               "#",
                               "\n",
                               " 1e38 ",
                               "-",
                               "\\",
                               "\xff",
                               "WorldBegin ",
                               "Include ",
                               "Import ",
                               "\"part.pbrt\"",
                               "1e-400 ",
                               "99999999999 ",
                               "AttributeBegin ",
                               "AttributeEnd ",
                               "ObjectEnd ",
                               "Scale 0 0 0 ",
                               "\"float x\" ",
                               "Attribute \"shape\" "};

class Mutator {
 public:
  explicit Mutator(uint64_t seed) : engine_(seed) {}
  size_t Below(size_t count) { return engine_() % count; }

  void Mutate(std::string* text) {
    if (text->empty()) return;
    const size_t at = Below(text->size());
    switch (Below(5)) {
      case 0: (*text)[at] = static_cast<char>(Below(256)); break;
      case 1: text->erase(at, 1 + Below(20)); break;
      case 2: text->insert(at, text->substr(Below(text->size()), Below(60))); break;
      case 3: text->insert(at, kPieces[Below(std::size(kPieces))]); break;
      default: text->resize(at); break;
    }
  }

 private:
  std::mt19937_64 engine_;
};

// Whether `message` starts with "file:line:column: " of one of the files and goes on, on one line.
bool HasPlace(const std::string& message) {
  const size_t file_end = message.find(':');
  if (file_end == std::string::npos) return false;
  const std::string file = message.substr(0, file_end);
  int line = 0, column = 0, length = 0;
  if (std::sscanf(message.c_str() + file_end, ":%d:%d: %n", &line, &column, &length) != 2) return false;
  return (file == "a.pbrt" || file == "part.pbrt") && line >= 1 && column >= 1 && length > 0 &&
         file_end + length < message.size() && message.find('\n') == std::string::npos;
}

TEST(Fuzz, MutatedScenesParseOrFailWithAPlace) {
  Mutator mutator(1);
  int failed = 0;
  constexpr int kScenes = 6000;
  for (int i = 0; i < kScenes; ++i) {
    MemoryFiles files;
    files.files["part.pbrt"] = "Material \"conductor\" Shape \"sphere\" \"float radius\" 2\n";
    std::string text = kSeeds[mutator.Below(std::size(kSeeds))];
    const size_t mutations = mutator.Below(6);
    for (size_t m = 0; m < mutations; ++m) {
      mutator.Mutate(mutator.Below(10) == 0 ? &files.files["part.pbrt"] : &text);
    }
    const Result<SceneDescription> scene = ParseSceneText(files, "a.pbrt", text);
    EXPECT_TRUE(scene || mutations > 0) << ErrorOf(scene);
    if (scene) continue;
    ++failed;
    ASSERT_TRUE(HasPlace(scene.error().message)) << scene.error().message << "\nfor:\n" << text;
  }
  EXPECT_GT(failed, kScenes / 3);  // the mutations do damage
  EXPECT_LT(failed, kScenes);
}

TEST(Fuzz, RandomBytesFailWithAPlace) {
  std::mt19937_64 engine(2);
  for (int i = 0; i < 2000; ++i) {
    std::string text;
    for (uint64_t n = engine() % 200; n > 0; --n) text += static_cast<char>(engine());
    const Result<SceneDescription> scene = ParseText(text);
    ASSERT_FALSE(scene.has_value());
    ASSERT_TRUE(HasPlace(scene.error().message)) << scene.error().message;
  }
}

TEST(Fuzz, EveryPrefixOfASceneFailsWithAPlaceOrParses) {
  for (const char* seed : kSeeds) {
    const std::string whole = seed;
    for (size_t length = 0; length < whole.size(); ++length) {
      MemoryFiles files;
      files.files["part.pbrt"] = "Shape \"sphere\"";
      const Result<SceneDescription> scene = ParseSceneText(files, "a.pbrt", whole.substr(0, length));
      ASSERT_TRUE(scene || HasPlace(ErrorOf(scene))) << ErrorOf(scene);
    }
  }
}

}  // namespace
}  // namespace tessera
