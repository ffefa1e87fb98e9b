// What every directive does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/renderer/pbrt/parse_helpers.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// The place of the origin of the only shape of a world with this text.
Point3 Origin(const std::string& world) {
  const SceneDescription scene = Parsed("WorldBegin\n" + world + "\nShape \"sphere\"");
  return scene.shapes.empty() ? Point3{-99, 0, 0}
                              : scene.shapes[0].world_from_object.First().ToPoint({0, 0, 0});
}

TEST(Directives, MissingOnesHaveTheDefaultsOfPbrt) {
  const SceneDescription scene = Parsed("WorldBegin");
  EXPECT_EQ(scene.camera.kind, "perspective");
  EXPECT_EQ(scene.film.kind, "rgb");
  EXPECT_EQ(scene.filter.kind, "gaussian");
  EXPECT_EQ(scene.sampler.kind, "zsobol");
  EXPECT_EQ(scene.integrator.kind, "volpath");
  EXPECT_EQ(scene.accelerator.kind, "bvh");
  EXPECT_EQ(scene.camera.directive, "Camera");
  EXPECT_TRUE(scene.camera_from_world.First().IsIdentity());
  EXPECT_EQ(scene.film_color_space, "srgb");
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].entity.kind, "diffuse");
  EXPECT_THAT(scene.diagnostics.WarningTexts(), IsEmpty());
}

TEST(Directives, KindsBeforeTheWorldAreKeptWithTheirParametersAndTheLastWins) {
  const SceneDescription scene = Parsed(
      "Camera \"spherical\" Camera \"orthographic\" \"float lensradius\" .5\nFilm \"gbuffer\" PixelFilter "
      "\"box\""
      "Sampler \"halton\" Integrator \"path\" \"integer maxdepth\" [ 7 ] Accelerator \"kdtree\" WorldBegin");
  EXPECT_EQ(scene.camera.kind, "orthographic");
  ASSERT_EQ(scene.camera.parameters.size(), 1u);
  EXPECT_EQ(scene.camera.parameters[0].name, "lensradius");
  EXPECT_EQ(scene.camera.location.Text(), "a.pbrt:1:20");
  EXPECT_EQ(scene.film.kind, "gbuffer");
  EXPECT_EQ(scene.filter.kind, "box");
  EXPECT_EQ(scene.sampler.kind, "halton");
  EXPECT_EQ(scene.integrator.kind, "path");
  EXPECT_THAT(scene.integrator.parameters[0].integers, ElementsAre(7));
  EXPECT_EQ(scene.accelerator.kind, "kdtree");
}

TEST(Directives, ValuesAreReadByTheirType) {
  const SceneDescription scene = Parsed(
      "Film \"rgb\" \"float f\" [ 1. .5 +3 -1e2 0x10 ] \"integer i\" [ -2147483648 +7 ] \"bool b\" [ true "
      "false ]"
      "\"string s\" [ \"a\\\"b\" \"\\t\" ] \"point2 p\" [ 1 2 ] \"spectrum e\" \"glass-BK7\" \"spectrum l\" "
      "[ 400 1 700 2 ]"
      "\"  rgb\tL  ignored\" [ .1 .2 .3 ] \"blackbody k\" 6500 WorldBegin");
  const std::vector<Parameter>& p = scene.film.parameters;
  ASSERT_EQ(p.size(), 9u);
  EXPECT_THAT(p[0].floats, ElementsAre(1, .5f, 3, -100, 16));
  EXPECT_THAT(p[1].integers, ElementsAre(-2147483648, 7));
  EXPECT_THAT(p[2].bools, ElementsAre(true, false));
  EXPECT_THAT(p[3].strings, ElementsAre("a\"b", "\t"));
  EXPECT_THAT(p[4].floats, ElementsAre(1, 2));
  EXPECT_THAT(p[5].strings, ElementsAre("glass-BK7"));
  EXPECT_THAT(p[6].floats, ElementsAre(400, 1, 700, 2));
  EXPECT_EQ(p[7].type, "rgb");
  EXPECT_EQ(p[7].name, "L");
  EXPECT_THAT(p[8].floats, ElementsAre(6500));
}

TEST(Directives, TransformsMultiplyFromTheRight) {
  EXPECT_EQ(Origin("Translate 1 2 3"), (Point3{1, 2, 3}));
  EXPECT_EQ(Origin("Scale 2 3 4 Translate 1 1 1"), (Point3{2, 3, 4}));
  EXPECT_EQ(Origin("Translate 1 1 1 Scale 2 3 4"), (Point3{1, 1, 1}));
  EXPECT_EQ(Origin("Translate 1 1 1 Identity"), (Point3{0, 0, 0}));
  const Point3 rotated = Origin("Rotate 90 0 0 1 Translate 1 0 0");
  EXPECT_NEAR(rotated.x, 0, 1e-6);
  EXPECT_NEAR(rotated.y, 1, 1e-6);
}

TEST(Directives, MatricesAreWrittenColumnByColumn) {
  EXPECT_EQ(Origin("Translate 9 9 9 Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 4 5 6 1 ]"), (Point3{4, 5, 6}));
  EXPECT_EQ(Origin("Translate 1 1 1 ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 4 5 6 1 ]"), (Point3{5, 6, 7}));
  const SceneDescription scene =
      Parsed("WorldBegin Transform [ 1 2 3 0 0 1 4 0 0 0 1 0 0 0 0 1 ] Shape \"sphere\"");
  EXPECT_EQ(scene.shapes[0].world_from_object.First().ToVector({1, 0, 0}), (Vec3{1, 2, 3}));
}

TEST(Directives, LookAtBeforeTheCameraIsCameraFromWorld) {
  const SceneDescription scene = Parsed("LookAt 0 0 5  0 0 0  0 1 0 Camera \"perspective\" WorldBegin");
  const Transform& camera_from_world = scene.camera_from_world.First();
  EXPECT_EQ(camera_from_world.ToPoint({0, 0, 5}), (Point3{0, 0, 0}));
  EXPECT_EQ(camera_from_world.ToPoint({0, 0, 0}), (Point3{0, 0, 5}));
  EXPECT_EQ(camera_from_world.ToVector({0, 1, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(camera_from_world.ToVector({1, 0, 0}), (Vec3{-1, 0, 0}));
}

TEST(Directives, WorldBeginResetsTheTransformAndNothingElse) {
  const SceneDescription scene = Parsed(
      "ColorSpace \"rec2020\" ActiveTransform StartTime Translate 1 2 3\nMakeNamedMedium \"m\" \"string "
      "type\" \"cloud\""
      "MediumInterface \"m\" WorldBegin Shape \"sphere\" \"rgb x\" [ 1 1 1 ] Translate 1 0 0 Shape \"disk\"");
  EXPECT_TRUE(scene.shapes[0].world_from_object.First().IsIdentity());
  EXPECT_FALSE(scene.shapes[0].world_from_object.IsAnimated());
  EXPECT_FALSE(scene.shapes[1].world_from_object.IsAnimated());
  EXPECT_EQ(scene.shapes[0].inside_medium, "m");
  EXPECT_EQ(scene.shapes[0].entity.parameters[0].color_space, "rec2020");
  EXPECT_EQ(scene.media[0].world_from_medium.ToPoint({0, 0, 0}), (Point3{1, 2, 3}));
}

TEST(Directives, ActiveTransformChoosesTheTimes) {
  const SceneDescription scene = Parsed(
      "TransformTimes .25 .75 WorldBegin Translate 1 0 0 ActiveTransform EndTime Translate 0 1 0 "
      "ActiveTransform "
      "StartTime Translate 0 0 1 ActiveTransform All Translate 1 0 0 Shape \"sphere\"");
  const AnimatedTransform& transform = scene.shapes[0].world_from_object;
  EXPECT_EQ(transform.At(.25)->ToPoint({0, 0, 0}), (Point3{2, 0, 1}));
  EXPECT_NE(transform.At(.26)->ToPoint({0, 0, 0}), (Point3{2, 0, 1}));
  EXPECT_NE(transform.At(.74)->ToPoint({0, 0, 0}), (Point3{2, 1, 0}));
  EXPECT_EQ(transform.At(.75)->ToPoint({0, 0, 0}), (Point3{2, 1, 0}));
}

TEST(Directives, ThingsMoveBetweenTimesZeroAndOneWithoutTransformTimes) {
  const SceneDescription scene =
      Parsed("WorldBegin ActiveTransform EndTime Translate 0 1 0 Shape \"sphere\"");
  EXPECT_EQ(scene.shapes[0].world_from_object.At(.5)->ToPoint({0, 0, 0}), (Point3{0, .5f, 0}));
  EXPECT_EQ(scene.shapes[0].world_from_object.At(1)->ToPoint({0, 0, 0}), (Point3{0, 1, 0}));
}

TEST(Directives, TransformTimesMayFollowTheCamera) {
  const SceneDescription scene =
      Parsed("ActiveTransform EndTime Translate 0 2 0 Camera \"perspective\" TransformTimes 3 5 WorldBegin");
  EXPECT_EQ(scene.camera_from_world.At(3)->ToPoint({0, 0, 0}), (Point3{0, 0, 0}));
  EXPECT_EQ(scene.camera_from_world.At(5)->ToPoint({0, 0, 0}), (Point3{0, 2, 0}));
}

TEST(Directives, ReversedTransformTimesMoveThingsInOneStep) {
  const SceneDescription scene =
      Parsed("TransformTimes 5 3 WorldBegin ActiveTransform EndTime Translate 0 2 0 Shape \"sphere\"");
  EXPECT_EQ(scene.shapes[0].world_from_object.At(5)->ToPoint({0, 0, 0}), (Point3{0, 0, 0}));
  EXPECT_EQ(scene.shapes[0].world_from_object.At(5.01)->ToPoint({0, 0, 0}), (Point3{0, 2, 0}));
}

TEST(Directives, CoordinateSystemsAreRestoredByName) {
  EXPECT_EQ(Origin("Translate 1 2 3 CoordinateSystem \"here\" Identity CoordSysTransform \"here\""),
            (Point3{1, 2, 3}));
  EXPECT_EQ(Origin("Translate 1 2 3 CoordSysTransform \"world\""), (Point3{0, 0, 0}));
  const SceneDescription scene = Parsed(
      "Translate 0 0 5 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\" Shape \"sphere\"");
  EXPECT_EQ(scene.shapes[0].world_from_object.First().ToPoint({0, 0, 0}), (Point3{0, 0, -5}));
}

TEST(Directives, UnknownCoordinateSystemsOnlyWarn) {
  const SceneDescription scene =
      Parsed("WorldBegin\nTranslate 1 0 0 CoordSysTransform \"x\" Shape \"sphere\"");
  EXPECT_THAT(
      scene.diagnostics.WarningTexts(),
      ElementsAre("a.pbrt:2:17: coordinate system \"x\" is not defined: the transformation is unchanged"));
  EXPECT_EQ(scene.shapes[0].world_from_object.First().ToPoint({0, 0, 0}), (Point3{1, 0, 0}));
}

TEST(Directives, AttributeEndRestoresTheWholeState) {
  const SceneDescription scene = Parsed(
      "MakeNamedMedium \"m\" \"string type\" \"cloud\" WorldBegin AttributeBegin\n Translate 1 0 0 "
      "ReverseOrientation "
      "Material \"conductor\" AreaLightSource \"diffuse\" MediumInterface \"m\" \"\" ColorSpace \"rec2020\" "
      "Attribute "
      "\"shape\" \"float zmax\" 1 ActiveTransform EndTime\nShape \"disk\" AttributeEnd\nTranslate 0 0 1 "
      "Shape \"sphere\" "
      "\"rgb c\" [ 1 1 1 ]");
  const ShapeDescription& inner = scene.shapes[0];
  EXPECT_TRUE(inner.reverse_orientation);
  EXPECT_EQ(inner.material.index, 1);
  ASSERT_TRUE(inner.area_light);
  EXPECT_EQ(inner.area_light->kind, "diffuse");
  EXPECT_EQ(inner.inside_medium, "m");
  EXPECT_EQ(inner.outside_medium, "");
  EXPECT_EQ(inner.entity.parameters.size(), 1u);
  const ShapeDescription& outer = scene.shapes[1];
  EXPECT_FALSE(outer.reverse_orientation);
  EXPECT_EQ(outer.material.index, 0);
  EXPECT_FALSE(outer.area_light);
  EXPECT_EQ(outer.inside_medium, "");
  ASSERT_EQ(outer.entity.parameters.size(), 1u);
  EXPECT_EQ(outer.entity.parameters[0].color_space, "srgb");
  EXPECT_FALSE(outer.world_from_object.IsAnimated());
  EXPECT_EQ(outer.world_from_object.First().ToPoint({0, 0, 0}), (Point3{0, 0, 1}));
}

TEST(Directives, TransformBeginIsADeprecatedAttributeBeginWithOneWarning) {
  const SceneDescription scene = Parsed(
      "WorldBegin\nTransformBegin Material \"conductor\" TransformEnd TransformBegin TransformEnd Shape "
      "\"sphere\"");
  EXPECT_EQ(scene.shapes[0].material.index, 0);
  EXPECT_THAT(
      scene.diagnostics.WarningTexts(),
      ElementsAre("a.pbrt:2:1: TransformBegin and TransformEnd are deprecated: use AttributeBegin and "
                  "AttributeEnd"));
}

TEST(Directives, ReverseOrientationToggles) {
  const SceneDescription scene =
      Parsed("WorldBegin ReverseOrientation Shape \"sphere\" ReverseOrientation Shape \"sphere\"");
  EXPECT_TRUE(scene.shapes[0].reverse_orientation);
  EXPECT_FALSE(scene.shapes[1].reverse_orientation);
}

TEST(Directives, ColorSpacesHaveAnyCaseAndTheOneAtFilmIsTheOutput) {
  const SceneDescription scene = Parsed(
      "ColorSpace \"ACES2065-1\" Film \"rgb\" ColorSpace \"dci-p3\" WorldBegin LightSource \"point\" \"rgb "
      "I\" [1 1 1]");
  EXPECT_EQ(scene.film_color_space, "aces2065-1");
  EXPECT_EQ(scene.lights[0].entity.parameters[0].color_space, "dci-p3");
}

TEST(Directives, AttributeDefaultsStandBehindExplicitOnesWithTheirOwnColorSpace) {
  const SceneDescription scene = Parsed(
      "Attribute \"material\" \"float roughness\" .1 \"rgb reflectance\" [ 1 0 0 ] ColorSpace \"rec2020\" "
      "Attribute "
      "\"material\" \"float roughness\" .2 WorldBegin Material \"diffuse\" \"rgb reflectance\" [ 0 1 0 ]");
  const std::vector<Parameter>& p = scene.materials[1].entity.parameters;
  ASSERT_EQ(p.size(), 4u);
  EXPECT_EQ(p[0].color_space, "rec2020");
  EXPECT_FALSE(p[0].is_default);
  EXPECT_EQ(p[1].floats[0], .1f);
  EXPECT_TRUE(p[1].is_default);
  EXPECT_EQ(p[2].color_space, "srgb");
  EXPECT_EQ(p[3].floats[0], .2f);
}

TEST(Directives, EachAttributeTargetReachesItsDirectives) {
  const SceneDescription scene = Parsed(
      "WorldBegin Attribute \"shape\" \"float s\" 1 Attribute \"light\" \"float l\" 1 Attribute \"medium\" "
      "\"float m\" 1 "
      "Attribute \"texture\" \"float t\" 1 Attribute \"material\" \"string type\" \"conductor\"\n"
      "AreaLightSource \"diffuse\" Shape \"sphere\" LightSource \"point\" MakeNamedMedium \"m\" \"string "
      "type\" \"cloud\""
      "Texture \"t\" \"float\" \"constant\" MakeNamedMaterial \"n\"");
  EXPECT_EQ(scene.shapes[0].entity.parameters[0].name, "s");
  EXPECT_EQ(scene.shapes[0].area_light->parameters[0].name, "l");
  EXPECT_EQ(scene.lights[0].entity.parameters[0].name, "l");
  EXPECT_EQ(scene.media[0].entity.parameters[0].name, "m");
  EXPECT_EQ(scene.textures[0].entity.parameters[0].name, "t");
  EXPECT_EQ(scene.materials[1].entity.kind, "conductor");
}

}  // namespace
}  // namespace tessera
