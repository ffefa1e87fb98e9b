// Light linking and visibility, by values in closed form: a wall under a point light, and what may be in
// between. That estimators agree is tested in estimator_test.cpp, and bits in kind_bits_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/scene/scene_links.h"
#include "tests/renderer/scene/layer_scenes.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr uint32_t kLinkSamples = 1024;

// Looks along +z at a wall of reflectance 0.5 that is 4 units away and called "wall".
constexpr const char* kLinkHead = R"(
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 2
Sampler "independent"
WorldBegin
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
)";
constexpr const char* kLinkWall =
    "Shape \"bilinearmesh\" \"string name\" \"wall\" \"point3 P\" [ -9 -9 4  9 -9 4  -9 9 4  9 9 4 ]\n";
// Light of intensity 16 from the camera's place: 0.5 / pi * 16 / 4^2.
constexpr const char* kLinkLamp = "LightSource \"point\" \"rgb I\" [ 16 16 16 ] ";
constexpr float kLit = 0.5f / 3.14159265f;
// Between the lamp and the wall.
constexpr const char* kLinkCard = "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 2  1 -1 2  -1 1 2  1 1 2 ] ";

Result<std::unique_ptr<Scene>> LoadWall(const std::string& world, const std::string& accelerator = "",
                                        const std::set<std::string>& layers = {},
                                        const std::string& integrator = "path") {
  MemoryFiles files({{"scene.pbrt", kLinkHead + world}});
  RenderOptions options;
  options.aovs = layers;
  options.samples_per_pixel = kLinkSamples;
  options.accelerator = accelerator;
  options.integrator = integrator;
  options.max_depth = 1;
  return Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
}

// The mean of a channel over the picture.
float PictureMean(const Scene& scene, const std::string& channel) {
  const RadianceTile tile = *scene.Render({0, 0, 4, 4}, {}, {0, kLinkSamples}, nullptr);
  const ChannelLayout layout = scene.frame().Layout();
  const size_t stride = layout.shape().stride();
  double sum = 0;
  for (size_t pixel = 0; pixel < 16; ++pixel)
    sum +=
        tile.sums[pixel * stride + *layout.SlotOf(channel)] / tile.sums[pixel * stride + *layout.SlotOf("W")];
  return static_cast<float>(sum / 16);
}

float BrightnessOf(const std::string& world, const std::string& integrator = "path") {
  const auto scene = LoadWall(world, "", {}, integrator);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? PictureMean(**scene, "G") : -1;
}

void ExpectBrightness(const std::string& world, float expected) {
  for (const char* integrator : {"path", "volpath", "simplepath"})
    EXPECT_NEAR(BrightnessOf(world, integrator), expected, 0.02f * kLit) << integrator << world;
}

TEST(LightLinks, ALightIlluminatesOnlyWhatItIncludesAndNotWhatItExcludes) {
  const std::string wall = kLinkWall, lamp = kLinkLamp;
  ExpectBrightness(wall + lamp, kLit);
  ExpectBrightness(wall + lamp + "\"string link_include\" \"wall\"", kLit);
  ExpectBrightness(wall + lamp + "\"string link_include\" [ \"x\" \"w?l*\" ]", kLit);
  ExpectBrightness(wall + lamp + "\"string link_include\" \"wal\"", 0);
  ExpectBrightness(wall + lamp + "\"string link_exclude\" \"wall\"", 0);
  ExpectBrightness(wall + lamp + "\"string link_exclude\" \"other\"", kLit);
  ExpectBrightness(wall + lamp + "\"string link_include\" \"*\" \"string link_exclude\" \"wall\"", 0);
}

TEST(LightLinks, AWallUnderTwoLightsHasTheLightOfTheLinkedOne) {
  ExpectBrightness(std::string(kLinkWall) + kLinkLamp + "\"string link_exclude\" \"wall\"\n" + kLinkLamp,
                   kLit);
  ExpectBrightness(std::string(kLinkWall) + kLinkLamp + kLinkLamp, 2 * kLit);
}

TEST(LightLinks, NamesAreThoseOfShapesAssetsAndObjects) {
  std::string named = kLinkWall;
  named.replace(named.find("name"), 4, "asset");
  ExpectBrightness(named + kLinkLamp + "\"string link_exclude\" \"wall\"", 0);
  std::string object = kLinkWall;
  object.replace(object.find("\"string name\" \"wall\""), 20, "");
  object = "ObjectBegin \"house\" " + object + " ObjectEnd ObjectInstance \"house\" ";
  ExpectBrightness(object + kLinkLamp + "\"string link_exclude\" \"hous*\"", 0);
  ExpectBrightness(object + kLinkLamp + "\"string link_include\" \"house\"", kLit);
  ExpectBrightness(object + kLinkLamp + "\"string link_include\" \"wall\"", 0);
}

TEST(LightLinks, ALightThatIlluminatesNothingElseIsStillSeen) {
  const std::string panel = std::string("AreaLightSource \"diffuse\" \"rgb L\" [ 3 3 3 ] \"string ") +
                            "link_include\" \"x\" \"bool twosided\" true " + kLinkCard;
  ExpectBrightness(panel, 3);
}

TEST(Visibility, AHiddenObjectIsPassedByTheRaysThatItIsHiddenFromAlone) {
  const std::string wall = kLinkWall, lamp = kLinkLamp, card = kLinkCard;
  ExpectBrightness(wall + lamp + card, 4 * kLit);  // the card, at half the distance
  ExpectBrightness(wall + lamp + card + "\"bool visible_camera\" false", 0);  // the shadow of the card
  ExpectBrightness(wall + lamp + card + "\"bool visible_camera\" false \"bool visible_shadow\" false", kLit);
  ExpectBrightness(wall + lamp + card + "\"bool visible_shadow\" false", 4 * kLit);
  ExpectBrightness(wall + lamp + card + "\"bool visible_indirect\" false", 4 * kLit);
}

TEST(Visibility, ALightThatCastsNoShadowsIlluminatesWhatIsBehindSomething) {
  const std::string behind = std::string(kLinkWall) + kLinkCard + "\"bool visible_camera\" false ";
  ExpectBrightness(behind + kLinkLamp + "\"bool cast_shadows\" false", kLit);
  ExpectBrightness(behind + kLinkLamp + "\"bool cast_shadows\" false " + kLinkLamp, kLit);
}

// A disk of radius r and radiance L at distance h over a wall that faces it gives an irradiance of
// pi L r^2 / (r^2 + h^2).
TEST(Visibility, AnEmitterThatScatteredRaysPassLightsAllTheSame) {
  const std::string lamp =
      "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] \"bool twosided\" true Shape \"disk\" "
      "\"float height\" 2 \"float radius\" 2 \"bool visible_camera\" false ";
  ExpectBrightness(kLinkWall + lamp, 0.5f * 0.5f);
  ExpectBrightness(kLinkWall + lamp + "\"bool visible_indirect\" false", 0.5f * 0.5f);
}

// A sphere of radius r that glows inside alone, at distance d: rays pass its near side with probability
// 1 - alpha and end on its far side with probability alpha. The irradiance of a radiance L would be
// pi L r^2 / d^2.
TEST(Visibility, APartlyTransparentSphereLightsFromItsFarSide) {
  const std::string lamp =
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 4 4 4 ] ReverseOrientation Translate 0 0 3 "
      "Shape \"sphere\" \"float radius\" 0.7 \"float alpha\" 0.4 \"bool visible_camera\" false AttributeEnd ";
  for (const char* integrator : {"path", "volpath", "simplevolpath", "mixture"})
    EXPECT_NEAR(BrightnessOf(kLinkWall + lamp, integrator), 0.5f * 4 * 0.49f * 0.4f * 0.6f, 0.02f)
        << integrator;
}

// On a glossy wall most of the light is found by scattered rays, which end at the card.
TEST(Visibility, GlossySurfacesHaveAllTheLightThatShadowRaysFind) {
  const std::string lit =
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 3 3 3 ] \"bool twosided\" true "
      "Shape \"bilinearmesh\" \"point3 P\" [ -3 -3 -1  3 -3 -1  -3 3 -1  3 3 -1 ] AttributeEnd "
      "LightSource \"infinite\" \"rgb L\" [ 0.5 0.5 0.5 ] "
      "Material \"conductor\" \"float roughness\" 0.3 " +
      std::string(kLinkWall);
  const std::string card =
      "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ] Shape \"bilinearmesh\" "
      "\"point3 P\" [ -3 -3 -0.5  3 -3 -0.5  -3 3 -0.5  3 3 -0.5 ] ";
  for (const char* integrator : {"path", "volpath", "simplepath"}) {
    const float open = BrightnessOf(lit, integrator);
    EXPECT_NEAR(BrightnessOf(lit + card + "\"bool visible_shadow\" false", integrator), open, 0.02f * open);
    EXPECT_LT(BrightnessOf(lit + card, integrator), 0.5f * open) << integrator;
  }
}

// A mirror in place of the wall shows what is behind the camera.
TEST(Visibility, AMirrorDoesNotShowWhatIsHiddenFromIndirectRays) {
  const std::string mirror =
      std::string("Material \"conductor\" \"float roughness\" 0 \"rgb reflectance\" ") +
      "[ 0.999 0.999 0.999 ] " + kLinkWall;
  const std::string panel =
      "AreaLightSource \"diffuse\" \"rgb L\" [ 3 3 3 ] \"bool twosided\" true "
      "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 -1  1 -1 -1  -1 1 -1  1 1 -1 ] ";
  EXPECT_NEAR(BrightnessOf(mirror + panel), 3, 0.02);
  EXPECT_NEAR(BrightnessOf(mirror + panel + "\"bool visible_camera\" false"), 3, 0.02);
  EXPECT_EQ(BrightnessOf(mirror + panel + "\"bool visible_indirect\" false"), 0);
}

TEST(Visibility, LayersShowWhatTheCameraSees) {
  const std::set<std::string> layers{"alpha", "depth", "crypto_object", "shadow"};
  const std::string hidden = std::string(kLinkCard) + "\"bool visible_camera\" false ";
  const auto before_wall = LoadWall(kLinkWall + hidden + kLinkLamp, "", layers);
  ASSERT_TRUE(before_wall) << before_wall.error().message;
  EXPECT_NEAR(PictureMean(**before_wall, "A"), 1, 1e-6);
  EXPECT_NEAR(PictureMean(**before_wall, "shadow.G"), kLit, 0.02 * kLit) << "the shadow of the hidden card";
  const RadianceTile wall = *(*before_wall)->Render({0, 0, 4, 4}, {}, {0, 16}, nullptr);
  const ChannelLayout layout = (*before_wall)->frame().Layout();
  EXPECT_NEAR(wall.sums[*layout.SlotOf("depth.Z")], 4, 1e-2);
  EXPECT_EQ(wall.sums[*layout.SlotOf("CryptoObject")], 1) << "one id: that of the wall";
  const auto alone = LoadWall(hidden + kLinkLamp, "", layers);
  ASSERT_TRUE(alone);
  EXPECT_EQ(PictureMean(**alone, "A"), 0);
  const RadianceTile empty = *(*alone)->Render({0, 0, 4, 4}, {}, {0, 16}, nullptr);
  EXPECT_EQ(empty.sums[*layout.SlotOf("depth.Z")], 0) << "nothing is hit";
  EXPECT_EQ(empty.sums[*layout.SlotOf("CryptoObject")], 0);
}

TEST(Visibility, ASkyThatIsHiddenFromTheCameraStillIlluminates) {
  const std::string sky = "LightSource \"infinite\" \"rgb L\" [ 2 2 2 ] ";
  ExpectBrightness(sky, 2);
  ExpectBrightness(sky + "\"bool visible_camera\" false", 0);
  EXPECT_NEAR(BrightnessOf(kLinkWall + sky + "\"bool visible_camera\" false"), 0.5f * 2, 0.01);
}

TEST(Visibility, AcceleratorsAgree) {
  const std::string world = std::string(kLinkWall) + kLinkCard +
                            "\"bool visible_camera\" false \"bool visible_shadow\" false Translate 0.01 0 1 "
                            "Shape \"sphere\" \"float radius\" 0.015 \"bool visible_shadow\" false " +
                            kLinkLamp;
  const auto sums = [&](const char* accelerator) {
    const auto scene = LoadWall(world, accelerator);
    EXPECT_TRUE(scene) << scene.error().message;
    return (*scene)->Render({0, 0, 4, 4}, {}, {0, 64}, nullptr)->sums;
  };
  const auto list = sums("list"), bvh = sums("bvh"), embree = sums("embree");
  EXPECT_EQ(list, bvh);
  ASSERT_EQ(list.size(), embree.size());
  for (size_t i = 0; i < list.size(); ++i) EXPECT_NEAR(list[i], embree[i], 1e-4f * std::abs(list[i])) << i;
}

TEST(LightLinks, WhatHasNoEffectIsAWarning) {
  const auto unknown =
      LoadWall(std::string(kLinkWall) + kLinkLamp + "\"string link_include\" [ \"wall\" \"walls\" ]");
  ASSERT_TRUE(unknown);
  EXPECT_THAT((*unknown)->summary().warnings,
              ElementsAre(HasSubstr("light link: no shape, asset or object is called \"walls\"")));
  const auto plain = LoadWall(std::string(kLinkWall) + kLinkLamp + "\"string link_include\" \"wall\"");
  ASSERT_TRUE(plain);
  EXPECT_THAT((*plain)->summary().warnings, IsEmpty());
  const auto walked =
      LoadWall(std::string(kLinkWall) + "\"bool visible_shadow\" false LightSource \"infinite\"", "", {},
               "randomwalk");
  ASSERT_TRUE(walked);
  EXPECT_THAT((*walked)->summary().warnings, ElementsAre(HasSubstr("\"visible_shadow\"")));
}

TEST(LightLinks, TooManyAreAnErrorWithItsPlace) {
  std::string world = kLinkWall;
  for (size_t i = 0; i + 1 < kLightLinksMax; ++i)
    world += std::string(kLinkLamp) + "\"string link_exclude\" \"x" + std::to_string(i) + "\"\n";
  world += std::string(kLinkLamp) + "\"string link_exclude\" \"x1\"\n";
  EXPECT_TRUE(LoadWall(world));
  const auto refused = LoadWall(world + kLinkLamp + "\"string link_exclude\" \"wall\"");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("scene.pbrt:73:1: the scene has more than 63 different"));
  std::string names;
  for (int i = 0; i <= 1000; ++i) names += " \"a" + std::to_string(i) + "\"";
  const auto many = LoadWall(std::string(kLinkWall) + kLinkLamp + "\"string link_exclude\" [" + names + " ]");
  ASSERT_FALSE(many);
  EXPECT_THAT(many.error().message, HasSubstr("has 1001 names, expected at most 1000"));
  const auto mistyped = LoadWall(std::string(kLinkWall) + kLinkLamp + "\"bool link_include\" true");
  ASSERT_FALSE(mistyped);
  EXPECT_THAT(mistyped.error().message, HasSubstr("link_include"));
}

}  // namespace
}  // namespace tessera
