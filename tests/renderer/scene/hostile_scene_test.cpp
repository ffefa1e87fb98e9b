// Degenerate and hostile scenes: each is rendered, or refused with its place, by every accelerator.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera::hostile_scene {
namespace {

struct HostileScene {
  const char* name;
  std::string settings, world;
  const char* error = "";    // a part of the message; empty: it renders
  const char* warning = "";  // a part of one of the warnings; empty: there may be none
};

constexpr const char* kHead =
    "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 3 Sampler \"zsobol\" \"integer "
    "pixelsamples\" 4\n";
constexpr const char* kCamera = "Translate 0 0 4 Camera \"perspective\"\n";
constexpr const char* kLights =
    "WorldBegin LightSource \"infinite\" LightSource \"point\" \"point3 from\" [ 1 1 -3 ]\n";

std::string Repeated(int count, const std::string& text) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

// Spheres around each other, from the outside, each in the medium of the one around it.
std::string NestedMedia(int count) {
  std::string text = "MakeNamedMedium \"m0\" \"string type\" \"homogeneous\" Material \"interface\"\n";
  for (int i = 1; i <= count; ++i) {
    text += fmt::format(
        "MakeNamedMedium \"m{0}\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0.01 0.01 0.01 ] "
        "MediumInterface \"m{0}\" \"{1}\" Shape \"sphere\" \"float radius\" {2}\n",
        i, i == 1 ? "" : fmt::format("m{}", i - 1), 3 - i * (2.5 / count));
  }
  return text;
}

std::string Grid(const std::string& parameters) {
  return "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" " + parameters +
         " MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"";
}

std::string Instance(const std::string& placement) {
  return "ObjectBegin \"o\" Shape \"sphere\" Shape \"disk\" ObjectEnd " + placement + " ObjectInstance \"o\"";
}

std::string Triangle(const std::string& P) {
  return "Shape \"trianglemesh\" \"point3 P\" [ " + P + " ]\n";
}

std::vector<HostileScene> HostileShapes() {
  const std::string ball = "Shape \"sphere\"";
  return {
      // Numbers
      {"NaN in a mesh", "", Triangle("nan 0 0 1 0 0 0 1 0"),
       "a.pbrt:4:35: unexpected \"nan\", expected a number"},
      {"too large for a float", "", Triangle("1e400 0 0 1 0 0 0 1 0"), "a.pbrt:4:35: unexpected \"1e400\""},
      {"the largest floats", "", Triangle("3e38 0 0 -3e38 0 0 0 3e38 0"),
       "a.pbrt:4:1: the shape is not within"},
      {"a tiny sphere", "", "Shape \"sphere\" \"float radius\" 1e-30"},
      {"a huge sphere", "", "Shape \"sphere\" \"float radius\" 1e16"},
      {"no radius", "", "Shape \"disk\" \"float radius\" 0", "a.pbrt:4:14: radius must be above 0"},
      {"a light of the largest power", "", "LightSource \"point\" \"float power\" 3e38 " + ball},
      // Areas of zero
      {"triangles without area", "",
       "AreaLightSource \"diffuse\" " + Triangle("0 0 0 1 0 0 2 0 0") + Triangle("0 0 0 0 0 0 0 0 0")},
      {"a patch that is a point", "",
       "AreaLightSource \"diffuse\" \"float power\" 9 Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 0 0 0 0 0 "
       "0 0 0 0 ]"},
      {"a curve that is a point", "",
       "Material \"hair\" Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" [ 1 0 0 1 0 0 1 0 0 1 0 "
       "0 ]"},
      {"hair of no width", "",
       "Material \"hair\" Shape \"curve\" \"float width\" 0 \"point3 P\" [ 0 0 0 1 0 0 1 1 0 2 1 0 ]"},
      {"hair of impossible parameters", "",
       "Material \"hair\" \"float beta_m\" 0 \"float beta_n\" 0 \"float alpha\" 1e30 \"float eta\" 0 \"rgb "
       "sigma_a\" "
       "[ 1e38 0 1 ] Shape \"curve\" \"float width\" 1 \"point3 P\" [ -1 0 0 1 0 0 1 1 0 2 1 0 ]"},
      // Transformations
      {"a singular matrix", "",
       "ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1 ] " + ball + " LightSource \"spot\"", "",
       "its transformation has no inverse"},
      {"a tiny instance", "", Instance("Scale 1e-30 1e-30 1e-30"), "",
       "a.pbrt:4:79: the object is not shown"},
      {"a huge instance", "", Instance("Scale 1e30 1e30 1e30"), "", "the object is not shown"},
      {"an instance far away", "", Instance("Translate 1e30 0 0"), "", "the object is not shown"},
      {"a small instance and a large room", "",
       Instance("AttributeBegin Scale 1e-11 1e-11 1e-11 ObjectInstance \"o\" AttributeEnd Translate 0 0 1e9 "
                "Scale 1e8 1e8 1")},
      {"an instance that shrinks to nothing", "",
       Instance("ActiveTransform EndTime Scale 1e-30 1e-30 1e-30 ActiveTransform All")},
      {"an instance that is always tiny", "",
       Instance("Scale 1e-30 1e-30 1e-30 ActiveTransform EndTime Translate 1 0 0 ActiveTransform All")},
      {"a camera of the largest scale",
       "Transform [ 1e38 0 0 0 0 1e38 0 0 0 0 1e38 0 0 0 0 1 ] Camera \"perspective\"", ball},
      {"a camera of the smallest scale",
       "Transform [ 1e-38 0 0 0 0 1e-38 0 0 0 0 1e-38 0 0 0 0 1 ] Camera \"perspective\"", ball},
      {"a camera without volume", "Scale 1 0 1 Camera \"perspective\"", ball,
       "the transformation of the camera has no inverse"},
      {"a scale that overflows", "", Repeated(50, "Scale 10 10 10\n") + ball, "is too large for a float"},
  };
}

std::vector<HostileScene> HostileWorlds() {
  const std::string ball = "Shape \"sphere\"";
  return {
      // What is missing or within something
      {"instances of an empty object", "",
       "ObjectBegin \"e\" ObjectEnd " + Repeated(1000, "ObjectInstance \"e\"\n")},
      {"the camera inside a solid", "",
       "Material \"dielectric\" Translate 0 0 -4 Shape \"sphere\" \"float radius\" 9"},
      {"the camera on a surface", "Camera \"perspective\"", "AreaLightSource \"diffuse\" Shape \"disk\""},
      {"a thousand nested media", "", NestedMedia(1000)},
      {"surfaces in one place", "", "Material \"interface\" " + Repeated(2000, ball + "\n")},
      {"dark lights in one place", "", Repeated(1000, "LightSource \"point\" \"rgb I\" [ 0 0 0 ]\n") + ball},
      // Media
      {"a grid of no cells", "", Grid("\"integer nx\" 0 \"float density\" [ ]"), "a.pbrt:4:"},
      {"a grid of more cells than values", "",
       Grid("\"integer nx\" 2097152 \"integer ny\" 2097152 \"integer nz\" 2097152 \"float density\" 1"),
       "a.pbrt:4:"},
      {"a grid of zeros", "", Grid("\"float density\" 0")},
      {"a flat grid", "", Grid("\"float density\" 1 \"point3 p0\" [ 1 1 1 ] \"point3 p1\" [ 1 1 1 ]"),
       "a.pbrt:4:"},
      {"a medium too dense to walk through", "", Grid("\"float density\" 1e9"), "the medium is too dense"},
      // Motion
      {"a shutter of the largest times",
       "Camera \"perspective\" \"float shutteropen\" -3e38 \"float shutterclose\" 3e38", ball,
       "the shutter is open for too long"},
      {"motion over the largest times", "TransformTimes -3e38 3e38 Camera \"perspective\"",
       "ActiveTransform EndTime Translate 1 0 0 ActiveTransform All " + ball},
  };
}

Result<std::unique_ptr<Scene>> Load(const HostileScene& scene, const std::string& accelerator) {
  const bool has_camera = scene.settings.find("Camera") != std::string::npos;
  MemoryFiles files(std::map<std::string, std::string>{
      {"a.pbrt",
       kHead + (has_camera ? scene.settings + "\n" : kCamera + scene.settings) + kLights + scene.world}});
  RenderOptions options;
  options.accelerator = accelerator;
  return Scene::Load(files, "a.pbrt", options, Scene::Depth::kRender);
}

void ExpectAllRenderedOrRefused(const std::vector<HostileScene>& scenes) {
  for (const HostileScene& hostile : scenes) {
    std::vector<float> first;
    for (const char* accelerator : {"embree", "bvh", "list"}) {
      SCOPED_TRACE(fmt::format("{}, {}", hostile.name, accelerator));
      const auto scene = Load(hostile, accelerator);
      if (*hostile.error != '\0') {
        ASSERT_FALSE(scene);
        EXPECT_EQ(scene.error().kind, ErrorKind::kBadInput);
        EXPECT_THAT(scene.error().message, testing::HasSubstr(hostile.error));
        EXPECT_THAT(scene.error().message, testing::StartsWith("a.pbrt:"));
        break;
      }
      ASSERT_TRUE(scene) << scene.error().message;
      const std::string warnings = fmt::format("{}", fmt::join((*scene)->summary().warnings, "\n"));
      EXPECT_THAT(warnings, testing::HasSubstr(hostile.warning));
      const auto tile = (*scene)->Render({0, 0, 4, 3}, {}, {0, 4}, nullptr);
      ASSERT_TRUE(tile);
      for (const float value : tile->sums) EXPECT_TRUE(std::isfinite(value));
      if (first.empty()) first = tile->sums;
      EXPECT_EQ(tile->sums, first);
    }
  }
}

TEST(HostileScene, OfShapesAndTransformationsIsRenderedOrRefusedWithItsPlace) {
  ExpectAllRenderedOrRefused(HostileShapes());
}

TEST(HostileScene, OfMediaLightsAndMotionIsRenderedOrRefusedWithItsPlace) {
  ExpectAllRenderedOrRefused(HostileWorlds());
}

TEST(HostileScene, OfManyLightsThatShareALargePictureIsRefusedBeforeTheirMapsAreMade) {
  constexpr size_t kSide = 2048;
  const std::string light = "LightSource \"infinite\" \"string filename\" \"sky.pfm\"\n";
  MemoryFiles files(std::map<std::string, std::string>{
      {"a.pbrt", kHead + std::string(kCamera) + kLights + Repeated(70, light)},
      {"sky.pfm", "Pf\n2048 2048\n-1.0\n" + std::string(kSide * kSide * 4, '\0')}});
  const auto scene = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kCheck);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().message,
            "a.pbrt:68:24: the pictures of the lights have more than 268435456 pixels");
}

TEST(HostileScene, OfCurvesWithTooManyPiecesIsRenderedFromFewerWithAWarning) {
  std::string P;
  for (int i = 0; i < 20'000; ++i) P += fmt::format("{} {} {} ", i % 3, i % 2, i * 1e-4);
  const std::string curves =
      "Shape \"curve\" \"string basis\" \"bspline\" \"float width\" 0.01 \"integer splitdepth\" 10 \"point3 "
      "P\" [ " +
      P + "]\n";
  for (const std::string& world :
       {curves, "ObjectBegin \"hair\" " + curves + "ObjectEnd ObjectInstance \"hair\""}) {
    const auto scene = Load({"", "", world}, "embree");
    ASSERT_TRUE(scene) << scene.error().message;
    const std::string warnings = fmt::format("{}", fmt::join((*scene)->summary().warnings, "\n"));
    EXPECT_THAT(warnings, testing::ContainsRegex("a.pbrt:4:[0-9]+: \"splitdepth\" is lowered to 7"));
    ASSERT_EQ((*scene)->summary().accelerators.size(), 1u);
    EXPECT_LT((*scene)->summary().accelerators[0].bytes, uint64_t{1} << 30);
  }
}

}  // namespace
}  // namespace tessera::hostile_scene
