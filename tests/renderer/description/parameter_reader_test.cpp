#include "renderer/description/parameter_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>

#include "tests/renderer/pbrt/parse_helpers.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// The camera with these parameters, written on line 2.
Entity Camera(const std::string& parameters) {
  Result<SceneDescription> scene = ParseText("Camera \"perspective\"\n" + parameters + "\nWorldBegin");
  EXPECT_TRUE(scene.has_value()) << ErrorOf(scene);
  return scene ? scene->camera : Entity();
}

// The first shape, after directives that may set defaults.
Entity Shape(const std::string& world) {
  Result<SceneDescription> scene = ParseText("WorldBegin\n" + world);
  EXPECT_TRUE(scene.has_value()) << ErrorOf(scene);
  return scene ? scene->shapes.at(0).entity : Entity();
}

std::string MessageOf(const Result<void>& result) {
  return result ? "no error" : result.error().message;
}

TEST(ParameterReader, GivesValuesByTypeAndNameAndElseTheDefault) {
  const Entity camera = Camera(
      "\"float f\" 2 \"integer i\" 3 \"bool b\" true \"string s\" \"x\" \"point2 p2\" [ 1 2 ] \"point3 p3\" "
      "[ 1 2 3 ]"
      "\"vector3 v\" [ 4 5 6 ]");
  ParameterReader reader(camera);
  EXPECT_EQ(reader.Float("f", 1), 2);
  EXPECT_EQ(reader.Integer("i", 1), 3);
  EXPECT_TRUE(reader.Bool("b", false));
  EXPECT_EQ(reader.String("s", ""), "x");
  EXPECT_EQ(reader.Point2Value("p2", {}), (Point2{1, 2}));
  EXPECT_EQ(reader.Point3Value("p3", {}), (Point3{1, 2, 3}));
  EXPECT_EQ(reader.Vector3Value("v", {}), (Vec3{4, 5, 6}));
  EXPECT_EQ(reader.Float("i", 9), 9);  // lookup is by the exact type
  EXPECT_EQ(reader.Point3Value("v", {7, 8, 9}), (Point3{7, 8, 9}));
  EXPECT_EQ(reader.FindFloat("g"), std::nullopt);
  EXPECT_EQ(reader.FindInteger("g"), std::nullopt);
  EXPECT_EQ(reader.FindString("g"), std::nullopt);
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");
}

// In time that grows with the number of parameters, not with its square: minutes for these.
TEST(ParameterReader, ReadsAParameterThatIsRepeatedAMillionTimes) {
  Parameter parameter;
  parameter.type = "float";
  parameter.name = "f";
  parameter.floats = {1};
  const Entity entity{"Camera", "perspective", {}, std::vector<Parameter>(1'000'000, parameter)};
  const std::clock_t start = std::clock();
  ParameterReader reader(entity);
  EXPECT_EQ(reader.Float("f", 2), 1);
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 20);
}

TEST(ParameterReader, GivesLists) {
  const Entity camera = Camera(
      "\"float f\" [ 1 2 ] \"integer i\" [ 3 4 ] \"string s\" [ \"x\" \"y\" ] \"point2 p2\" [ 1 2 3 4 ] "
      "\"point3 p3\" "
      "[ 1 2 3 4 5 6 ] \"vector3 v\" [ 1 2 3 ] \"normal N\" [ 0 0 1 ]");
  ParameterReader reader(camera);
  EXPECT_THAT(reader.Floats("f"), ElementsAre(1, 2));
  EXPECT_THAT(reader.Integers("i"), ElementsAre(3, 4));
  EXPECT_THAT(reader.Strings("s"), ElementsAre("x", "y"));
  EXPECT_THAT(reader.Point2s("p2"), ElementsAre(Point2{1, 2}, Point2{3, 4}));
  EXPECT_THAT(reader.Point3s("p3"), ElementsAre(Point3{1, 2, 3}, Point3{4, 5, 6}));
  EXPECT_THAT(reader.Vector3s("v"), ElementsAre(Vec3{1, 2, 3}));
  EXPECT_THAT(reader.Normals("N"), ElementsAre(Normal3{0, 0, 1}));
  EXPECT_THAT(reader.Floats("none"), IsEmpty());
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");
}

TEST(ParameterReader, RefusesParametersThatNobodyRead) {
  const Entity camera = Camera("  \"float fovv\" 40");
  ParameterReader reader(camera);
  reader.Float("fov", 90);
  reader.Float("lensradius", 0);
  EXPECT_EQ(MessageOf(reader.Finish()),
            "a.pbrt:2:3: unknown parameter \"float fovv\" of Camera \"perspective\" (did you mean \"fov\"?)");
}

TEST(ParameterReader, TellsTheTypeThatTheNameShouldHave) {
  const Entity camera = Camera("\"integer fov\" 40");
  ParameterReader reader(camera);
  reader.Float("fov", 90);
  EXPECT_EQ(
      MessageOf(reader.Finish()),
      "a.pbrt:2:1: \"integer fov\" of Camera \"perspective\" has the wrong type, expected \"float fov\"");

  const Entity shape = Shape("Shape \"sphere\" \"string alpha\" \"x\"");
  ParameterReader shape_reader(shape);
  shape_reader.FindTexture("alpha");
  shape_reader.FindFloat("alpha");
  EXPECT_EQ(MessageOf(shape_reader.Finish()),
            "a.pbrt:2:16: \"string alpha\" of Shape \"sphere\" has the wrong type, expected \"texture "
            "alpha\" or \"float "
            "alpha\"");
}

TEST(ParameterReader, TellsWrongCounts) {
  struct Row {
    const char* parameter;
    void (*read)(ParameterReader&);
    const char* message;
  };
  const Row rows[] = {
      {"\"float f\" [ 1 2 ]", [](ParameterReader& r) { r.Float("f", 0); },
       "\"float f\" of Camera \"perspective\" has 2 values, expected 1"},
      {"\"integer f\" [ 1 2 3 ]", [](ParameterReader& r) { r.Integer("f", 0); },
       "\"integer f\" of Camera \"perspective\" has 3 values, expected 1"},
      {"\"bool f\" [ true true ]", [](ParameterReader& r) { r.Bool("f", false); },
       "\"bool f\" of Camera \"perspective\" has 2 values, expected 1"},
      {"\"string f\" [ \"a\" \"b\" ]", [](ParameterReader& r) { r.String("f", ""); },
       "\"string f\" of Camera \"perspective\" has 2 values, expected 1"},
      {"\"texture f\" [ \"a\" \"b\" ]", [](ParameterReader& r) { r.FindTexture("f"); },
       "\"texture f\" of Camera \"perspective\" has 2 values, expected 1"},
      {"\"point3 f\" 1", [](ParameterReader& r) { r.Point3Value("f", {}); },
       "\"point3 f\" of Camera \"perspective\" has 1 value, expected 3"},
      {"\"point2 f\" [ 1 2 3 ]", [](ParameterReader& r) { r.Point2Value("f", {}); },
       "\"point2 f\" of Camera \"perspective\" has 3 values, expected 2"},
      {"\"point3 f\" [ 1 2 3 4 ]", [](ParameterReader& r) { r.Point3s("f"); },
       "\"point3 f\" of Camera \"perspective\" has 4 values, expected a multiple of 3"},
      {"\"point2 f\" [ 1 2 3 ]", [](ParameterReader& r) { r.Point2s("f"); },
       "\"point2 f\" of Camera \"perspective\" has 3 values, expected a multiple of 2"},
      {"\"rgb f\" [ 1 2 ]", [](ParameterReader& r) { r.FindSpectrum("f"); },
       "\"rgb f\" of Camera \"perspective\" has 2 values, expected 3"},
      {"\"blackbody f\" [ 1 2 ]", [](ParameterReader& r) { r.FindSpectrum("f"); },
       "\"blackbody f\" of Camera \"perspective\" has 2 values, expected 1"},
      {"\"blackbody f\" 0", [](ParameterReader& r) { r.FindSpectrum("f"); },
       "\"blackbody f\" of Camera \"perspective\" is 0 kelvin, expected more than 0"},
      {"\"spectrum f\" [ 400 1 500 ]", [](ParameterReader& r) { r.FindSpectrum("f"); },
       "\"spectrum f\" of Camera \"perspective\" has 3 values, expected pairs of wavelength and value"},
      {"\"spectrum f\" [ 400 1 400 2 ]", [](ParameterReader& r) { r.FindSpectrum("f"); },
       "\"spectrum f\" of Camera \"perspective\" has wavelength 400 after 400, expected rising wavelengths"},
      {"\"spectrum f\" [ \"a\" \"b\" ]", [](ParameterReader& r) { r.FindSpectrum("f"); },
       "\"spectrum f\" of Camera \"perspective\" has 2 values, expected 1"},
  };
  for (const Row& row : rows) {
    const Entity camera = Camera(row.parameter);
    ParameterReader reader(camera);
    row.read(reader);
    EXPECT_TRUE(reader.failed());
    EXPECT_EQ(MessageOf(reader.Finish()), std::string("a.pbrt:2:1: ") + row.message);
  }
}

TEST(ParameterReader, TheLastOfSeveralExplicitOnesWins) {
  const Entity camera = Camera("\"float f\" 1 \"float f\" 2");
  ParameterReader reader(camera);
  EXPECT_EQ(reader.Float("f", 0), 2);
  EXPECT_EQ(reader.LocationOf("f").Text(), "a.pbrt:2:13");
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");  // the first is shadowed, not unknown
}

TEST(ParameterReader, ExplicitOnesWinOverDefaultsAndLaterDefaultsOverEarlier) {
  const Entity shape = Shape(
      "Attribute \"shape\" \"float a\" 1 \"float b\" 1 Attribute \"shape\" \"float b\" 2 \"float unused\" 3\n"
      "Shape \"sphere\" \"float a\" 9");
  ParameterReader reader(shape);
  EXPECT_EQ(reader.Float("a", 0), 9);
  EXPECT_EQ(reader.Float("b", 0), 2);
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");  // a default may stay unused
}

TEST(ParameterReader, AValueWrittenLaterThanATextureTakesItsPlace) {
  const Entity shape =
      Shape("Attribute \"shape\" \"texture alpha\" \"t\" Shape \"sphere\" \"float alpha\" .5");
  ParameterReader reader(shape);
  EXPECT_EQ(reader.FindTexture("alpha"), std::nullopt);
  EXPECT_EQ(reader.Float("alpha", 1), .5f);
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");

  const Entity texture =
      Shape("Attribute \"shape\" \"float alpha\" .5 Shape \"sphere\" \"texture alpha\" \"t\"");
  ParameterReader texture_reader(texture);
  EXPECT_EQ(texture_reader.FindTexture("alpha"), "t");
  EXPECT_EQ(MessageOf(texture_reader.Finish()), "no error");
}

TEST(ParameterReader, TwoExplicitValuesOfDifferentTypesAreRefusedAsByPbrt) {
  const Entity shape = Shape("Shape \"sphere\" \"float alpha\" .5 \"texture alpha\" \"t\"");
  ParameterReader reader(shape);
  EXPECT_EQ(reader.FindTexture("alpha"), "t");
  reader.FindFloat("beta");
  EXPECT_EQ(MessageOf(reader.Finish()),
            "a.pbrt:2:16: \"float alpha\" of Shape \"sphere\" is not used beside its other values");
}

TEST(ParameterReader, SpectraHaveFourForms) {
  const Entity camera = Camera(
      "\"rgb r\" [ .1 .2 .3 ] \"blackbody k\" 6500 \"spectrum n\" \"metal-Cu-eta\" \"spectrum s\" [ 400 1 "
      "700 2 ]");
  ParameterReader reader(camera);
  const std::optional<SpectrumValue> rgb = reader.FindSpectrum("r");
  ASSERT_TRUE(rgb.has_value());
  EXPECT_EQ(rgb->form, SpectrumValue::Form::kRgb);
  EXPECT_EQ(rgb->rgb, (Vec3{.1f, .2f, .3f}));
  EXPECT_EQ(rgb->color_space, "srgb");
  EXPECT_EQ(rgb->location.Text(), "a.pbrt:2:1");
  const std::optional<SpectrumValue> blackbody = reader.FindSpectrum("k");
  ASSERT_TRUE(blackbody.has_value());
  EXPECT_EQ(blackbody->form, SpectrumValue::Form::kBlackbody);
  EXPECT_EQ(blackbody->kelvin, 6500);
  const std::optional<SpectrumValue> named = reader.FindSpectrum("n");
  ASSERT_TRUE(named.has_value());
  EXPECT_EQ(named->form, SpectrumValue::Form::kNamed);
  EXPECT_EQ(named->name, "metal-Cu-eta");
  const std::optional<SpectrumValue> samples = reader.FindSpectrum("s");
  ASSERT_TRUE(samples.has_value());
  EXPECT_EQ(samples->form, SpectrumValue::Form::kSamples);
  EXPECT_THAT(samples->wavelengths, ElementsAre(400, 700));
  EXPECT_THAT(samples->values, ElementsAre(1, 2));
  EXPECT_FALSE(reader.FindSpectrum("none").has_value());
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");
}

TEST(ParameterReader, ChoicesSuggestTheNearest) {
  constexpr std::string_view kMappings[] = {"equalarea", "equirectangular"};
  const Entity camera = Camera("\"string mapping\" \"equal-area\" \"string other\" \"equirectangular\"");
  ParameterReader reader(camera);
  EXPECT_EQ(reader.Choice("other", "equalarea", kMappings), "equirectangular");
  EXPECT_EQ(reader.Choice("none", "equalarea", kMappings), "equalarea");
  EXPECT_EQ(reader.Choice("mapping", "equalarea", kMappings), "equalarea");
  EXPECT_EQ(MessageOf(reader.Finish()),
            "a.pbrt:2:1: \"string mapping\" of Camera \"perspective\" is \"equal-area\", expected one of "
            "\"equalarea\", "
            "\"equirectangular\" (did you mean \"equalarea\"?)");
}

TEST(ParameterReader, OnlyTheFirstErrorIsKept) {
  const Entity camera = Camera("\"float fov\" 1");
  ParameterReader reader(camera);
  EXPECT_TRUE(reader.Has("fov"));
  EXPECT_FALSE(reader.Has("fo"));
  reader.FailAt("fov", "too small");
  reader.Fail("another");
  EXPECT_EQ(MessageOf(reader.Finish()), "a.pbrt:2:1: too small");
  ParameterReader second(camera);
  second.Fail("bad");
  EXPECT_EQ(MessageOf(second.Finish()), "a.pbrt:1:1: bad");
}

TEST(ParameterReader, KindsMayIgnoreTheirParameters) {
  const Entity camera = Camera("\"float fovv\" 1");
  ParameterReader reader(camera);
  reader.IgnoreRest();
  EXPECT_EQ(MessageOf(reader.Finish()), "no error");
}

}  // namespace
}  // namespace tessera
