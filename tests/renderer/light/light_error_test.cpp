#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

struct BadLight {
  const char* text;
  const char* message;
};

void PrintTo(const BadLight& bad, std::ostream* out) {
  *out << bad.text;
}

class LightErrors : public testing::TestWithParam<BadLight> {};

TEST_P(LightErrors, NameTheirLocation) {
  LightScene lights;
  const float infinity = std::numeric_limits<float>::infinity();
  lights.files.files["wide.pfm"] = Pfm({{1, 1, 1}, {1, 1, 1}}, 2);
  lights.files.files["black.pfm"] = Pfm({{0, 0, 0}}, 1);
  lights.files.files["infinite.pfm"] = Pfm({{infinity, 0, 0}}, 1);
  lights.files.files["cut.IES"] = "TILT=NONE\n";
  const std::string text = GetParam().text;
  std::vector<Shape> shapes;
  if (text.find("\"disk\"") != std::string::npos) shapes.push_back(DiskShape(0, 1));
  if (text.find("\"curve\"") != std::string::npos) {
    CurveSet curve;
    curve.P = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    curve.segments = {{0, 1, 1}};
    shapes.push_back({{}, std::move(curve)});
  }
  lights.Build(text, shapes);
  EXPECT_EQ(lights.error, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Table, LightErrors,
    testing::Values(
        BadLight{"LightSource \"pont\"", "lights.pbrt:3:1: unknown light \"pont\" (did you mean \"point\"?)"},
        BadLight{"LightSource \"spot\" \"float conedeltaangle\" -1",
                 "lights.pbrt:3:20: \"conedeltaangle\" must not be negative"},
        BadLight{"LightSource \"projection\" \"string filename\" \"wide.pfm\" \"float fov\" 180",
                 "lights.pbrt:3:55: \"fov\" must be between 0 and 180 degrees"},
        BadLight{"LightSource \"infinite\" \"point3 portal\" [ 0 0 0 1 0 0 1 1 0 ]",
                 "lights.pbrt:3:24: a portal has 4 corners, found 3"},
        BadLight{"LightSource \"infinite\" \"point3 portal\" [ 0 0 0 1 0 0 1 0 0 0 0 0 ]",
                 "lights.pbrt:3:24: the corners of the portal must span a rectangle"},
        BadLight{"LightSource \"infinite\" \"point3 portal\" [ 1e38 0 0 1 0 0 1 1 0 -1e38 1 0 ]",
                 "lights.pbrt:3:24: the corners of the portal must span a rectangle"},
        BadLight{"LightSource \"infinite\" \"point3 portal\" [ 0 0 0 1 0 0 1 1 0 0 1 0 ] \"rgb L\" [ 1 1 1 ] "
                 "\"string filename\" \"black.pfm\"",
                 "lights.pbrt:3:68: an infinite light takes \"L\" or \"filename\", not both"},
        BadLight{"LightSource \"infinite\" \"rgb L\" [ 1 1 1 ] \"string filename\" \"black.pfm\"",
                 "lights.pbrt:3:24: an infinite light takes \"L\" or \"filename\", not both"},
        BadLight{"LightSource \"infinite\" \"string filename\" \"wide.pfm\"",
                 "lights.pbrt:3:24: the image is not square; environment maps must be equal-area octahedral "
                 "(pbrt's imgtool makeequiarea converts them)"},
        BadLight{
            "LightSource \"infinite\" \"string filename\" \"infinite.pfm\"",
            "lights.pbrt:3:24: \"infinite.pfm\" contains infinite or NaN values, which a light cannot emit"},
        BadLight{"LightSource \"infinite\" \"string filename\" \"black.pfm\" \"float illuminance\" 1",
                 "lights.pbrt:3:54: \"illuminance\" cannot be reached: the upper half of the image is black"},
        BadLight{"LightSource \"spot\" \"point3 from\" [ 1 2 3 ] \"point3 to\" [ 1 2 3 ]",
                 "lights.pbrt:3:44: \"from\" and \"to\" must be different points"},
        BadLight{"LightSource \"projection\"", "lights.pbrt:3:1: a projection light requires \"filename\""},
        BadLight{
            "LightSource \"goniometric\" \"string filename\" \"wide.pfm\"",
            "lights.pbrt:3:27: \"wide.pfm\" is not square; goniometric maps must be equal-area octahedral"},
        BadLight{"AreaLightSource \"diffuse\" Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 2 0 0 3 0 0 ]",
                 "lights.pbrt:3:27: a curve cannot be an area light (it has that of lights.pbrt:3:1)"},
        BadLight{"LightSource \"goniometric\"", "lights.pbrt:3:1: a goniometric light requires \"filename\""},
        BadLight{"LightSource \"goniometric\" \"string filename\" \"cut.IES\"",
                 "lights.pbrt:3:27: cut.IES: line 2: the file ends where the number of lamps is expected"},
        BadLight{"AreaLightSource \"difuse\" Shape \"disk\"",
                 "lights.pbrt:3:1: unknown area light \"difuse\" (did you mean \"diffuse\"?)"},
        BadLight{"AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] \"string filename\" \"black.pfm\" Shape "
                 "\"disk\"",
                 "lights.pbrt:3:27: an area light takes \"L\" or \"filename\", not both"},
        BadLight{
            "AreaLightSource \"diffuse\" \"string filename\" \"black.pfm\" \"float power\" 5 Shape \"disk\"",
            "lights.pbrt:3:57: \"power\" cannot be reached: the image is black"}));

TEST(LightErrorMessages, UnknownParameterGetsASuggestion) {
  LightScene lights;
  lights.Build("LightSource \"point\" \"float powr\" 5");
  EXPECT_EQ(lights.error.find("lights.pbrt:3:21: "), 0u) << lights.error;
  EXPECT_NE(lights.error.find("power"), std::string::npos) << lights.error;
}

TEST(LightErrorMessages, NameAMissingImage) {
  LightScene lights;
  lights.Build("LightSource \"infinite\" \"string filename\" \"nowhere.exr\"");
  EXPECT_EQ(lights.error.find("lights.pbrt:3:24: "), 0u) << lights.error;
  EXPECT_NE(lights.error.find("nowhere.exr"), std::string::npos) << lights.error;
}

TEST(LightErrorMessages, UnknownLightSamplerIsRefused) {
  EXPECT_EQ(LightSamplers().Find("powr"), nullptr);
  EXPECT_EQ(LightSamplers().Refusal("powr"), "unknown light sampler \"powr\" (did you mean \"power\"?)");
}

// The reader of the scene warns about it (tests/renderer/pbrt/world_test.cpp).
TEST(LightWarnings, MovingLightStaysWhereItStarts) {
  LightScene lights;
  lights.Build("ActiveTransform EndTime Translate 1 0 0 ActiveTransform All\nLightSource \"point\"");
  EXPECT_EQ(lights.error, "");
  EXPECT_NEAR(SampleLuminance(lights.table, 0, At({0, 0, 2}), {}), 0.25f, 1e-4f);
}

}  // namespace
}  // namespace tessera
