// Materials, lights, media, objects and options of the scene language.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/renderer/pbrt/parse_helpers.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(World, NamedMaterialsMayBeDefinedAfterTheirUse) {
  const SceneDescription scene = Parsed(
      "WorldBegin NamedMaterial \"gold\" Shape \"sphere\" Material \"dielectric\" Shape \"disk\"\n"
      "MakeNamedMaterial \"gold\" \"float roughness\" .1 \"string type\" \"conductor\"");
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.shapes[0].material.index, 2);
  EXPECT_EQ(scene.shapes[0].material.name, "gold");
  EXPECT_EQ(scene.shapes[1].material.index, 1);
  EXPECT_EQ(scene.shapes[1].material.name, "");
  EXPECT_EQ(scene.named_materials.at("gold"), 2);
  EXPECT_EQ(scene.materials[2].entity.kind, "conductor");
  ASSERT_EQ(scene.materials[2].entity.parameters.size(), 1u);  // the type is no parameter of the kind
  EXPECT_EQ(scene.materials[2].entity.parameters[0].name, "roughness");
}

TEST(World, UndefinedMaterialsThatNoShapeHasAreFine) {
  EXPECT_TRUE(
      ParseText("WorldBegin NamedMaterial \"nothing\" Material \"diffuse\" Shape \"sphere\"").has_value());
}

TEST(World, TheLastExplicitTypeOfANamedMaterialWins) {
  const SceneDescription scene = Parsed(
      "Attribute \"material\" \"string type\" \"mix\" WorldBegin MakeNamedMaterial \"m\" \"string type\" "
      "\"conductor\" "
      "\"string type\" \"dielectric\"");
  EXPECT_EQ(scene.materials[1].entity.kind, "dielectric");
}

TEST(World, FloatAndSpectrumTexturesHaveNamesOfTheirOwn) {
  const SceneDescription scene = Parsed(
      "WorldBegin Translate 1 0 0 Texture \"t\" \"float\" \"imagemap\" Texture \"t\" \"spectrum\" "
      "\"constant\"");
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_FALSE(scene.textures[0].is_spectrum);
  EXPECT_TRUE(scene.textures[1].is_spectrum);
  EXPECT_EQ(scene.textures[1].entity.kind, "constant");
  EXPECT_EQ(scene.textures[0].world_from_texture.ToPoint({0, 0, 0}), (Point3{1, 0, 0}));
}

TEST(World, MediumInterfaceWithOneNameSetsBothSides) {
  const SceneDescription scene = Parsed(
      "MakeNamedMedium \"a\" \"string type\" \"cloud\" MakeNamedMedium \"b\" \"string type\" "
      "\"homogeneous\"\n"
      "MediumInterface \"a\" Camera \"perspective\" WorldBegin Shape \"sphere\" MediumInterface \"a\" \"b\"\n"
      "Shape \"sphere\" LightSource \"point\" MediumInterface \"\" Shape \"sphere\"");
  EXPECT_EQ(scene.camera_medium, "a");
  EXPECT_EQ(scene.shapes[0].inside_medium, "a");
  EXPECT_EQ(scene.shapes[0].outside_medium, "a");
  EXPECT_EQ(scene.shapes[1].inside_medium, "a");
  EXPECT_EQ(scene.shapes[1].outside_medium, "b");
  EXPECT_EQ(scene.lights[0].outside_medium, "b");
  EXPECT_EQ(scene.shapes[2].inside_medium, "");
  EXPECT_EQ(scene.media[1].entity.kind, "homogeneous");
}

TEST(World, AnEmptyAreaLightSwitchesEmissionOff) {
  const SceneDescription scene = Parsed(
      "WorldBegin AreaLightSource \"diffuse\" \"float scale\" 2 Shape \"sphere\" AreaLightSource \"\" Shape "
      "\"sphere\"");
  ASSERT_TRUE(scene.shapes[0].area_light);
  EXPECT_EQ(scene.shapes[0].area_light->directive, "AreaLightSource");
  EXPECT_EQ(scene.shapes[0].area_light->parameters[0].floats[0], 2);
  EXPECT_FALSE(scene.shapes[1].area_light);
}

TEST(World, AreaLightsInObjectsAreIgnoredWithAWarning) {
  const SceneDescription scene = Parsed(
      "WorldBegin AreaLightSource \"diffuse\"\nObjectBegin \"o\"\nShape \"disk\" ObjectEnd Shape \"disk\"");
  EXPECT_FALSE(scene.objects[0].shapes[0].area_light);
  EXPECT_TRUE(scene.shapes[0].area_light);
  EXPECT_THAT(scene.diagnostics.WarningTexts(),
              ElementsAre("a.pbrt:3:1: the area light is ignored: shapes in object definitions cannot emit"));
}

TEST(World, MovingTexturesAndMediaWarn) {
  const SceneDescription scene = Parsed(
      "WorldBegin ActiveTransform EndTime Translate 1 0 0\nLightSource \"point\"\nTexture \"t\" \"float\" "
      "\"c\"\n"
      "MakeNamedMedium \"m\" \"string type\" \"cloud\"");
  EXPECT_THAT(
      scene.diagnostics.WarningTexts(),
      ElementsAre("a.pbrt:3:1: the texture does not move: the transformation at the start time is used",
                  "a.pbrt:4:1: the medium does not move: the transformation at the start time is used"));
}

TEST(World, WarningsAreBounded) {
  std::string text = "WorldBegin ActiveTransform EndTime Translate 1 0 0\n";
  for (int i = 0; i < 1000; ++i) text += "Texture \"t" + std::to_string(i) + "\" \"float\" \"constant\"\n";
  const SceneDescription scene = Parsed(text);
  ASSERT_EQ(scene.diagnostics.WarningTexts().size(), 101u);
  EXPECT_EQ(scene.diagnostics.WarningTexts().back(), "900 further warnings");
}

// Its picture is seen through the portal, which has its place in the world.
TEST(World, AnInfiniteLightWithAPortalStaysWhereItIsAtTheStart) {
  const SceneDescription scene = Parsed(
      "WorldBegin Rotate 10 0 0 1 ActiveTransform EndTime Rotate 90 0 0 1\n"
      "LightSource \"infinite\"\nLightSource \"infinite\" \"point3 portal\" [ 0 0 0 1 0 0 1 1 0 0 1 0 ]");
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_TRUE(scene.lights[0].world_from_light.IsAnimated());
  EXPECT_FALSE(scene.lights[1].world_from_light.IsAnimated());
  EXPECT_EQ(scene.lights[1].world_from_light.First(), scene.lights[0].world_from_light.First());
  EXPECT_THAT(
      scene.diagnostics.WarningTexts(),
      ElementsAre("a.pbrt:3:1: the light with a portal does not move: the transformation at the start time "
                  "is used"));
}

TEST(World, ObjectsHoldTheirShapesAndInstancesPlaceThem) {
  const SceneDescription scene = Parsed(
      "WorldBegin Translate 1 0 0 ObjectBegin \"o\" Translate 0 1 0 Shape \"sphere\" AttributeBegin Shape "
      "\"disk\" "
      "AttributeEnd LightSource \"point\" ObjectEnd Shape \"cylinder\"\nObjectBegin \"empty\" ObjectEnd "
      "Scale 2 2 2\n"
      "ObjectInstance \"o\" ActiveTransform EndTime Translate 1 1 1 ObjectInstance \"empty\"");
  ASSERT_EQ(scene.objects.size(), 2u);
  ASSERT_EQ(scene.objects[0].shapes.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "o");
  EXPECT_EQ(scene.objects[0].shapes[0].world_from_object.First().ToPoint({0, 0, 0}), (Point3{1, 1, 0}));
  EXPECT_EQ(scene.lights.size(), 1u);
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(scene.shapes[0].world_from_object.First().ToPoint({0, 0, 0}), (Point3{1, 0, 0}));
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].world_from_object.First().ToPoint({1, 0, 0}), (Point3{3, 0, 0}));
  EXPECT_FALSE(scene.instances[0].world_from_object.IsAnimated());
  EXPECT_TRUE(scene.instances[1].world_from_object.IsAnimated());
}

TEST(World, OptionsHaveNormalisedNames) {
  const SceneDescription scene = Parsed(
      "Option \"disable_Pixel-Jitter\" true Option \"seed\" -3 Option \"displacement-edge-scale\" 2.5\n"
      "Option \"msereferenceout\" \"x.exr\" WorldBegin Option \"render-coord-sys\" \"world\"");
  ASSERT_EQ(scene.options.size(), 5u);
  EXPECT_EQ(scene.options[0].name, "disablepixeljitter");
  EXPECT_THAT(scene.options[0].bools, ElementsAre(true));
  EXPECT_EQ(scene.options[1].type, "integer");
  EXPECT_THAT(scene.options[1].integers, ElementsAre(-3));
  EXPECT_THAT(scene.options[2].floats, ElementsAre(2.5f));
  EXPECT_THAT(scene.options[3].strings, ElementsAre("x.exr"));
  EXPECT_EQ(scene.options[4].name, "rendercoordsys");
}

}  // namespace
}  // namespace tessera
