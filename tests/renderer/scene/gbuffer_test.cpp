// The film "gbuffer" against closed forms.
#include "renderer/scene/gbuffer.h"

#include <gtest/gtest.h>

#include <map>

#include "renderer/film/tile_painter.h"
#include "tests/renderer/scene/layer_scenes.h"

namespace tessera {
namespace {

// Half of the view is a grey wall across it, 4 units in front of a camera at (1, 2, 3) that looks along -x;
// the rest is sky.
std::string Wall(const std::string& film) {
  return R"(
LookAt 1 2 3  0 2 3  0 1 0
Film "gbuffer" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false )" +
         film + R"(
PixelFilter "box"
Camera "perspective" "float fov" 90
Sampler "independent"
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "bilinearmesh" "point3 P" [ -3 2 -17  -3 2 23  -3 22 -17  -3 22 23 ]
)";
}

std::map<std::string, float> PixelOf(const Scene& scene, int x, int y) {
  const ChannelLayout layout = scene.frame().Layout();
  const RadianceTile tile = *scene.Render({x, y, x + 1, y + 1}, {}, {0, kLayerSamples}, nullptr);
  const TilePainter painter(scene.frame().PictureChannels(), layout);
  PixelSource pixel(layout, 1, tile.sums, kLayerSamples);
  pixel.Next();
  const std::vector<std::string> names = painter.Names();
  std::vector<float> painted(names.size());
  painter.Paint(pixel, painted.data());
  std::map<std::string, float> values;
  for (size_t i = 0; i < names.size(); ++i) values[names[i]] = painted[i];
  return values;
}

TEST(Gbuffer, HasTheChannelsOfPbrt) {
  const auto scene = LoadWith(Wall(""), {});
  std::set<std::string> names;
  for (const PictureChannel& channel : scene->frame().PictureChannels()) names.insert(channel.name);
  EXPECT_EQ(names, (std::set<std::string>{"R",
                                          "G",
                                          "B",
                                          "Albedo.R",
                                          "Albedo.G",
                                          "Albedo.B",
                                          "P.X",
                                          "P.Y",
                                          "P.Z",
                                          "dzdx",
                                          "dzdy",
                                          "N.X",
                                          "N.Y",
                                          "N.Z",
                                          "Ns.X",
                                          "Ns.Y",
                                          "Ns.Z",
                                          "u",
                                          "v",
                                          "Variance.R",
                                          "Variance.G",
                                          "Variance.B",
                                          "RelativeVariance.R",
                                          "RelativeVariance.G",
                                          "RelativeVariance.B"}));
}

TEST(Gbuffer, GeometryIsInTheSpaceOfTheCamera) {
  const auto scene = LoadWith(Wall(""), {});
  // Pixel (3, 1) sees the wall from 2 to 4 units to the right and 0 to 2 up.
  auto pixel = PixelOf(*scene, 3, 1);
  EXPECT_NEAR(pixel["P.X"], 3, 0.1f);
  EXPECT_NEAR(pixel["P.Y"], 1, 0.1f);
  EXPECT_NEAR(pixel["P.Z"], 4, 1e-4f);
  EXPECT_NEAR(std::abs(pixel["N.Z"]), 1, 1e-6f);
  EXPECT_NEAR(std::abs(pixel["Ns.Z"]), 1, 1e-6f);
  EXPECT_NEAR(pixel["dzdx"], 0, 1e-5f) << "the wall is across the view";
  EXPECT_NEAR(pixel["Albedo.G"], 0.5f, 0.02f);
}

TEST(Gbuffer, GeometryIsInWorldSpaceIfTheFilmSaysSo) {
  const auto scene = LoadWith(Wall("\"string coordinatesystem\" \"world\""), {});
  auto pixel = PixelOf(*scene, 3, 1);
  EXPECT_NEAR(pixel["P.X"], -3, 1e-4f);
  EXPECT_NEAR(pixel["P.Y"], 3, 0.1f);
  EXPECT_NEAR(std::abs(pixel["P.Z"] - 3), 3, 0.1f);
  EXPECT_NEAR(std::abs(pixel["N.X"]), 1, 1e-6f);
  // The wall's own axes: u along z, v along y.
  EXPECT_NEAR(pixel["u"], (pixel["P.Z"] + 17) / 40, 1e-4f);
  EXPECT_NEAR(pixel["v"], (pixel["P.Y"] - 2) / 20, 1e-4f);
}

// A pixel whose upper half sees the wall, as the camera looks half a pixel lower.
TEST(Gbuffer, GeometryIsTheMeanOfTheSamplesThatHitAndAlbedoThatOfAll) {
  std::string text = Wall("");
  text.replace(text.find("LookAt 1 2 3  0 2 3"), 19, "LookAt 1 1 3  0 1 3");
  const auto scene = LoadWith(text, {});
  // Rows are 2 units high at the wall, whose edge is 1 unit above the camera's height.
  auto pixel = PixelOf(*scene, 2, 1);
  EXPECT_NEAR(pixel["P.Z"], 4, 1e-4f);
  EXPECT_NEAR(pixel["P.Y"], 1.5f, 0.1f);
  EXPECT_NEAR(pixel["Albedo.G"], 0.25f, 0.04f);
  auto sky = PixelOf(*scene, 2, 3);
  for (const char* name : {"P.X", "P.Z", "N.Z", "Albedo.G", "u", "dzdx", "Variance.G", "RelativeVariance.G"})
    EXPECT_EQ(sky[name], 0) << name;
}

TEST(Gbuffer, SlopeIsTheChangeOfDepthOverAPixel) {
  // The wall turned by 45 degrees about the vertical through its middle: z changes as x does.
  std::string text = Wall("");
  text.replace(text.find("-3 2 -17  -3 2 23  -3 22 -17  -3 22 23"), 39,
               "7 2 -7  -13 2 13  7 22 -7  -13 22 13");
  text.replace(text.find("\"float fov\" 90"), 14, "\"float fov\" 1");
  const auto scene = LoadWith(text, {});
  auto pixel = PixelOf(*scene, 2, 1);
  const float pixel_width = 2 * 4 * std::tan(0.5f * 3.14159265f / 180) / 4;
  const float scale = 0.125f;  // of the footprint for samplers whose samples can be extended
  EXPECT_NEAR(pixel["dzdx"], pixel_width * scale, 0.1f * pixel_width * scale);
  EXPECT_NEAR(pixel["dzdy"], 0, 1e-4f);
}

TEST(Gbuffer, VarianceIsThatOfTheSamples) {
  const auto scene = LoadWith(Wall(""), {});
  const ChannelLayout layout = scene->frame().Layout();
  double sum = 0, squares = 0;
  for (uint32_t i = 0; i < kLayerSamples; ++i) {
    const RadianceTile one = *scene->Render({3, 1, 4, 2}, {}, {i, 1}, nullptr);
    const double value = one.sums[*layout.SlotOf("G")] / one.sums[layout.weight()];
    sum += value;
    squares += value * value;
  }
  const double n = kLayerSamples;
  const double expected = (squares - sum * sum / n) / (n - 1);
  auto pixel = PixelOf(*scene, 3, 1);
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(pixel["Variance.G"], expected, 1e-3 * expected);
  EXPECT_NEAR(pixel["RelativeVariance.G"], expected / (sum / n), 1e-3 * expected);
}

TEST(Gbuffer, TakesOtherLayersToo) {
  const auto scene = LoadWith(Wall("\"string layers\" \"depth\""), {"all"});
  EXPECT_TRUE(scene->frame().Layout().SlotOf("depth.Z"));
  EXPECT_TRUE(scene->frame().Layout().SlotOf("Albedo.R"));
  EXPECT_TRUE(scene->frame().Layout().SlotOf("albedo.R"));
}

}  // namespace
}  // namespace tessera
