// Names that are composed in one place of a scene and decomposed in another.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

constexpr const char* kComposed = "m\xc3\xa9\xc3\xa5";
constexpr const char* kDecomposed =
    "me\xcc\x81"
    "a\xcc\x8a";

// A scene that defines everything that has a name as `defined` and refers to it as `used`.
std::string SceneText(const std::string& defined, const std::string& used) {
  return fmt::format(R"(Film "rgb" "integer xresolution" 8 "integer yresolution" 8
Sampler "independent" Integrator "volpath" "integer maxdepth" 4
LookAt 0 0 -4  0 0 0  0 1 0  Camera "perspective" "float fov" 60
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
MakeNamedMedium "{0}" "string type" "homogeneous" "rgb sigma_a" [0.5 1 2] "rgb sigma_s" [1 1 1]
Texture "{0}" "spectrum" "checkerboard" "spectrum tex1" [300 0.1 900 0.9] "spectrum tex2" [300 0.8 900 0.1]
MakeNamedMaterial "{0}" "string type" "diffuse" "texture reflectance" "{1}"
MakeNamedMaterial "dark" "string type" "diffuse" "rgb reflectance" [0.1 0.1 0.1]
MakeNamedMaterial "both" "string type" "mix" "string materials" ["{1}" "dark"]
ObjectBegin "{0}" NamedMaterial "{1}" Shape "sphere" "float radius" 0.5 ObjectEnd
Translate 1 0 0 CoordinateSystem "{0}" Translate -2 0 0
ObjectInstance "{1}"
CoordSysTransform "{1}"
NamedMaterial "both" Shape "sphere" "float radius" 0.5
AttributeBegin Material "interface" MediumInterface "{1}" "" Translate -1 1 0 Shape "sphere" AttributeEnd
)",
                     defined, used);
}

std::vector<float> Sums(const std::string& text) {
  MemoryFiles files({{"scene.pbrt", text}});
  const auto scene = Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kRender);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? (*scene)->Render({0, 0, 8, 8}, {}, {0, 4}, nullptr)->sums : std::vector<float>();
}

TEST(Names, AreTheSameComposedOrDecomposed) {
  const std::vector<float> expected = Sums(SceneText(kComposed, kComposed));
  EXPECT_EQ(Sums(SceneText(kComposed, kDecomposed)), expected);
  EXPECT_EQ(Sums(SceneText(kDecomposed, kComposed)), expected);
  EXPECT_EQ(Sums(SceneText(kDecomposed, kDecomposed)), expected);
  EXPECT_NE(Sums(SceneText("plain", "plain")), std::vector<float>());
}

TEST(Names, OfFilesAreLeftAsTheyAre) {
  const std::string name = std::string(kDecomposed) + ".pbrt";
  MemoryFiles files({{"scene.pbrt", "WorldBegin LightSource \"infinite\" Include \"" + name + "\""},
                     {name, "Shape \"sphere\""}});
  EXPECT_TRUE(Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kCheck));
}

}  // namespace
}  // namespace tessera
