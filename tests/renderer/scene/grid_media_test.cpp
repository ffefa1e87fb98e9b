// Pictures of media that vary, against the same pictures of homogeneous media and closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/renderer/scene/media_scenes.h"

namespace tessera::media_scenes {
namespace {

// A grid of 2 x 2 x 2 equal voxels, of which the ball in the middle of the scene lies between the centres:
// the density is the same everywhere in it.
std::string EvenGrid(const std::string& name, double density, double sigma_a, double sigma_s,
                     const std::string& more = "") {
  std::string densities;
  for (int i = 0; i < 8; ++i) densities += std::to_string(density) + " ";
  std::string text = Medium(name, sigma_a, sigma_s, more);
  text.replace(text.find("homogeneous"), 11, "uniformgrid");
  text.pop_back();
  return "AttributeBegin\n" + text +
         " \"integer nx\" 2 \"integer ny\" 2 \"integer nz\" 2 \"point3 p0\" [ -3 -3 1 ] \"point3 p1\" [ 3 3 "
         "7 ]" +
         " \"float density\" [ " + densities + "]\nAttributeEnd\n";
}

// A sphere around everything that glows.
constexpr const char* kWall = R"(
AttributeBegin
ReverseOrientation
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "sphere" "float radius" 9
AttributeEnd
)";

// Everywhere in the ball the largest majorant is that of the density, so that not even the noise may differ
// much.
TEST(GridMedia, EvenGridLooksLikeTheHomogeneousMediumOfItsDensity) {
  const std::string head = Wide(kVolPath) + "WorldBegin\n" + kEvenLight + kDistantLight;
  for (const auto& [sigma_a, sigma_s] : {std::pair(0.5, 0.0), std::pair(0.2, 1.5), std::pair(0.0, 4.0)}) {
    const std::string ball = Ball("\"interface\"", "m");
    const Pixels expected = Render(head + Medium("m", sigma_a, sigma_s, "\"float g\" 0.3") + ball, 2048);
    const std::string grid = EvenGrid("m", 2, sigma_a / 2, sigma_s / 2, "\"float g\" 0.3");
    ExpectMean(Render(head + grid + ball, 2048), expected, 1, 0.01, std::to_string(sigma_s));
    RenderOptions simple;
    simple.integrator = "simplevolpath";
    const std::string even = Wide(kVolPath) + "WorldBegin\n" + kEvenLight;
    ExpectMean(Render(even + grid + ball, 2048, simple),
               Render(even + Medium("m", sigma_a, sigma_s, "\"float g\" 0.3") + ball, 2048, simple), 1, 0.01,
               "simplevolpath");
  }
}

// Glass around it, an absorbing fog around that, and the camera in the fog.
TEST(GridMedia, GridInsideADielectricInsideAnotherGridLooksLikeTheHomogeneousMedia) {
  const std::string head = Wide(kVolPath),
                    ball = Ball("\"dielectric\"", "m") + Ball("\"interface\"", "n", 1.5);
  std::string nested = ball;
  nested.replace(nested.find("\"m\" \"\""), 6, "\"m\" \"n\"");
  nested.replace(nested.find("\"n\" \"\""), 6, "\"n\" \"fog\"");
  const std::string fog = Medium("fog", 0.05, 0.02) + "MediumInterface \"\" \"fog\"\n";
  std::string world = std::string("WorldBegin\nMediumInterface \"fog\" \"fog\"\n") + kWall;
  const Pixels expected =
      Render(fog + head + world + Medium("m", 0.3, 1) + Medium("n", 0.1, 0.5) + nested, 2048);
  const Pixels found =
      Render(fog + head + world + EvenGrid("m", 1, 0.3, 1) + EvenGrid("n", 0.25, 0.4, 2) + nested, 2048);
  ExpectMean(found, expected, 1, 0.01);
}

// The camera is in the middle of a grid, and the wall at a distance of 9 in its even part.
TEST(GridMedia, CameraCanBeInsideAGrid) {
  std::string grid = EvenGrid("m", 2, 0.05, 0);
  const auto replace = [&grid](const std::string& from, const std::string& to) {
    grid.replace(grid.find(from), from.size(), to);
  };
  replace("AttributeBegin\n", "");  // which is not allowed before the world
  replace("AttributeEnd\n", "");
  replace("-3 -3 1", "-20 -20 -20");
  replace("3 3 7", "20 20 20");
  const std::string head = Wide(kVolPath), world = std::string("WorldBegin\n") + kWall;
  ExpectMean(Render(grid + "MediumInterface \"\" \"m\"\n" + head + world, 1024), Render(head + world, 1024),
             std::exp(-0.1 * 9), 0.02);
}

TEST(GridMedia, EmissionOfAnAbsorbingGridIsTheClosedForm) {
  const std::string head = Narrow(kVolPath) + "WorldBegin\n", ball = Ball("\"interface\"", "m");
  const Pixels light = Render(head + kEvenLight, 4096);
  const double seen = 1 - std::exp(-0.4 * 2);
  ExpectMean(Render(head + EvenGrid("m", 2, 0.2, 0, "\"rgb Le\" [ 3 3 3 ]") + ball, 4096), light, 3 * seen,
             0.02);
  const std::string scale = "\"rgb Le\" [ 3 3 3 ] \"float Lescale\" [ 2 2 2 2 2 2 2 2 ]";
  ExpectMean(Render(head + EvenGrid("m", 2, 0.2, 0, scale) + ball, 4096), light, 6 * seen, 0.02);
}

// A temperature shows the colour of a homogeneous medium with the same black body, whose radiance is
// normalised.
TEST(GridMedia, HotGridHasTheColorOfABlackBody) {
  const std::string head = Narrow(kVolPath) + "WorldBegin\n", ball = Ball("\"interface\"", "m");
  const Pixels found = Render(
      head + EvenGrid("m", 1, 0.4, 0, "\"float temperature\" [ 3000 3000 3000 3000 3000 3000 3000 3000 ]") +
          ball,
      4096);
  const Pixels expected = Render(head + Medium("m", 0.4, 0, "\"blackbody Le\" 3000") + ball, 4096);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(found.Mean(c) / found.Mean(0), expected.Mean(c) / expected.Mean(0), 0.03);
  }
}

// In an oven of uniform temperature a medium emits what it absorbs, however it varies.
TEST(GridMedia, VaryingMediumIsInvisibleInAnOvenOfItsRadiance) {
  const std::string head = Wide(kVolPath) + "WorldBegin\n" + kWall;
  const Pixels empty = Render(head, 512);
  const std::string medium = R"(
AttributeBegin
Translate -1 -1 3 Scale 2 2 2
MakeNamedMedium "m" "string type" "uniformgrid" "integer nx" 3 "integer ny" 2 "integer nz" 2
  "float density" [ 0 1 4 2 0 0 3 1 0 1 5 0 ] "rgb sigma_a" [ 0.1 0.5 2 ] "rgb sigma_s" [ 1 0.2 0.4 ]
  "rgb Le" [ 1 1 1 ] "float g" 0.4
AttributeEnd
)";
  ExpectMean(Render(head + medium + Ball("\"interface\"", "m"), 2048), empty, 1, 0.02);
  RenderOptions simple;
  simple.integrator = "simplevolpath";
  ExpectMean(Render(head + medium + Ball("\"interface\"", "m"), 2048, simple), empty, 1, 0.02);
}

TEST(GridMedia, CloudDarkensWhatIsBehindItAndUnitsRenderedTwiceHaveTheSameBits) {
  const std::string text = Wide(kVolPath) + "WorldBegin\n" + kEvenLight + R"(
AttributeBegin
Translate -1 -1 3 Scale 2 2 2
MakeNamedMedium "m" "string type" "cloud" "float density" 2 "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 4 4 4 ]
AttributeEnd
)" + Ball("\"interface\"", "m");
  EXPECT_LT(Render(text, 64).Mean(1),
            0.98 * Render(Wide(kVolPath) + "WorldBegin\n" + kEvenLight, 64).Mean(1));
  const auto first = LoadMedia(text), second = LoadMedia(text);
  ASSERT_TRUE(first && second);
  const RadianceTile expected = *(*first)->Render({2, 1, 7, 8}, {}, {8, 8}, nullptr);
  (void)(*second)->Render({0, 0, 8, 8}, {}, {0, 4}, nullptr);
  EXPECT_EQ(*(*second)->Render({2, 1, 7, 8}, {}, {8, 8}, nullptr), expected);
}

TEST(GridMedia, AThousandNestedMediaAreRendered) {
  std::string text = Wide(kVolPath) + "WorldBegin\n" + kEvenLight;
  for (int i = 1; i < 1000; ++i) {
    const std::string name = "m" + std::to_string(i), outside = i == 1 ? "" : "m" + std::to_string(i - 1);
    text += Medium(name, 0.001, 0.001) + "AttributeBegin\nTranslate 0 0 4\nMediumInterface \"" + name +
            "\" \"" + outside + "\"\nMaterial \"interface\"\nShape \"sphere\" \"float radius\" " +
            std::to_string(1 - 0.0009 * i) + "\nAttributeEnd\n";
  }
  EXPECT_GT(Render(text, 1).Mean(1), 0);
}

}  // namespace
}  // namespace tessera::media_scenes
