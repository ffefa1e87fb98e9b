// What pbrt-v4 complains of, or not even that, and renders all the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera::leniency {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Outcome {
  std::vector<std::string> warnings;
  std::vector<float> values;  // of the picture
  PixelBounds crop;
};

std::string WithFilm(const std::string& film, const std::string& world) {
  return "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 8 \"bool savefp16\" false " + film +
         "\nCamera \"perspective\"\nSampler \"independent\" \"integer pixelsamples\" 4\nWorldBegin\n" +
         "LightSource \"infinite\"\nTranslate 0 0 4\n" + world;
}

Outcome Render(const std::string& text, const RenderOptions& options = {}) {
  MemoryFiles files({{"a.pbrt", text}});
  const Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "a.pbrt", options, Scene::Depth::kRender);
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  const FrameSpec& frame = (*scene)->frame();
  Merger merger(frame);
  for (int tile = 0; tile < frame.TileCount(); ++tile) {
    for (const SampleRange range : DyadicPartition(frame.samples_per_pixel)) {
      EXPECT_TRUE(merger.Add(tile, *(*scene)->Render(frame.TileBounds(tile), {}, range, nullptr)));
    }
  }
  return {(*scene)->summary().warnings, merger.Picture().values, frame.crop};
}

std::string ErrorOf(const std::string& text) {
  MemoryFiles files({{"a.pbrt", text}});
  const Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kCheck);
  return scene ? "" : scene.error().message;
}

const std::string kBall = "Shape \"sphere\"\n";

TEST(Leniency, CropWindowsAreSortedAndClamped) {
  const PixelBounds left_half{0, 0, 8, 8};
  for (const std::string window : {"0 .5 0 1", ".5 0 0 1", ".5 0 1 0", "-3 .5 0 7", ".5 -0.1 1.5 -1"}) {
    const Outcome outcome = Render(WithFilm("\"float cropwindow\" [ " + window + " ]", kBall));
    EXPECT_EQ(outcome.crop, left_half) << window;
    EXPECT_THAT(outcome.warnings, IsEmpty());
  }
  EXPECT_EQ(ErrorOf(WithFilm("\"float cropwindow\" [ 2 3 0 1 ]", kBall)),
            "a.pbrt:1:83: the cropwindow holds no pixel");
}

TEST(Leniency, PixelBoundsAreSortedAndClampedWithAWarning) {
  const PixelBounds some{2, 1, 8, 5};
  for (const std::string bounds : {"2 8 1 5", "8 2 1 5", "8 2 5 1"}) {
    const Outcome outcome = Render(WithFilm("\"integer pixelbounds\" [ " + bounds + " ]", kBall));
    EXPECT_EQ(outcome.crop, some) << bounds;
    EXPECT_THAT(outcome.warnings, IsEmpty());
  }
  const Outcome outcome = Render(WithFilm("\"integer pixelbounds\" [ 99 -4 -1 5 ]", kBall));
  EXPECT_EQ(outcome.crop, (PixelBounds{0, 0, 16, 5}));
  EXPECT_THAT(outcome.warnings,
              ElementsAre("a.pbrt:1:83: pixelbounds reach beyond the film and are cut at its border"));
}

TEST(Leniency, CropsOfAnotherNumberOfValuesAreIgnoredWithAWarning) {
  const Outcome outcome = Render(WithFilm("\"float cropwindow\" [ 0 .5 ]", kBall));
  EXPECT_EQ(outcome.crop, (PixelBounds{0, 0, 16, 8}));
  EXPECT_THAT(outcome.warnings,
              ElementsAre("a.pbrt:1:83: cropwindow is ignored: it has 2 values, expected x0 x1 y0 y1"));
}

TEST(Leniency, AScreenWindowOfAnotherNumberOfValuesIsIgnoredWithAWarning) {
  std::string text = WithFilm("", kBall);
  const Outcome plain = Render(text);
  const Outcome outcome = Render(text.insert(text.find("\nSampler"), " \"float screenwindow\" [ -1 1 ]"));
  EXPECT_EQ(outcome.values, plain.values);
  EXPECT_THAT(outcome.warnings,
              ElementsAre("a.pbrt:2:22: screenwindow is ignored: it has 2 values, expected x0 x1 y0 y1"));
}

TEST(Leniency, AnUnknownTextureMappingIsUvWithAWarning) {
  const std::string texture = "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 ";
  const std::string ball = "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n" + kBall;
  const Outcome plain = Render(WithFilm("", texture + ball));
  const Outcome outcome = Render(WithFilm("", texture + "\"string mapping\" \"cubic\"" + ball));
  EXPECT_EQ(outcome.values, plain.values);
  EXPECT_THAT(
      outcome.warnings,
      ElementsAre("a.pbrt:7:56: \"string mapping\" of Texture \"checkerboard\" is \"cubic\", expected "
                  "one of \"uv\", \"spherical\", \"cylindrical\", \"planar\"; \"uv\" is used, as in "
                  "pbrt"));
}

TEST(Leniency, AnUnknownLightSamplerIsBvhWithAWarning) {
  const std::string text = WithFilm("", kBall);
  const Outcome outcome = Render("Integrator \"volpath\" \"string lightsampler\" \"powr\"\n" + text);
  EXPECT_EQ(outcome.values, Render(text).values);
  EXPECT_THAT(outcome.warnings,
              ElementsAre("a.pbrt:1:22: unknown light sampler \"powr\" (did you mean \"power\"?); \"bvh\" is "
                          "used, as in pbrt"));
}

TEST(Leniency, AConstantBesideATextureOfItsNameIsRefusedInAnyOrder) {
  const std::string textures =
      "Texture \"r\" \"float\" \"constant\" \"float value\" 0.3 "
      "Texture \"s\" \"spectrum\" \"constant\" \"rgb value\" [ .1 .2 .3 ]\n";
  const std::string constant = "\"float roughness\" 0.1 ", texture = "\"texture roughness\" \"r\" ";
  const std::string color = "\"rgb reflectance\" [ 1 1 1 ] ", map = "\"texture reflectance\" \"s\" ";
  for (const std::string& pair : {constant + texture, texture + constant, color + map, map + color}) {
    EXPECT_THAT(ErrorOf(WithFilm("", textures + "Material \"coateddiffuse\" " + pair + kBall)),
                testing::HasSubstr("of Material \"coateddiffuse\" is not used beside its other values"))
        << pair;
  }
}

TEST(Leniency, AnAttributeEndTooManyIsIgnoredWithAWarning) {
  const Outcome plain = Render(WithFilm("", kBall));
  const Outcome more =
      Render(WithFilm("", "AttributeBegin AttributeEnd AttributeEnd\n" + kBall + "AttributeEnd"));
  EXPECT_EQ(more.values, plain.values);
  EXPECT_THAT(more.warnings,
              ElementsAre("a.pbrt:7:29: AttributeEnd without AttributeBegin before it is ignored",
                          "a.pbrt:9:1: AttributeEnd without AttributeBegin before it is ignored"));
}

TEST(Leniency, AnUnknownColorSpaceChangesNothingButAWarning) {
  const std::string ball = "Material \"diffuse\" \"rgb reflectance\" [ .2 .5 .1 ]\n" + kBall;
  const Outcome plain = Render(WithFilm("", "ColorSpace \"rec2020\" " + ball));
  const Outcome unknown = Render(WithFilm("", "ColorSpace \"rec2020\" ColorSpace \"acescg\" " + ball));
  EXPECT_EQ(unknown.values, plain.values);
  EXPECT_THAT(unknown.warnings,
              ElementsAre("a.pbrt:7:22: unknown colour space \"acescg\", expected one of srgb dci-p3 "
                          "rec2020 aces2065-1: the colour space is still rec2020"));
}

const std::string kSquare =
    "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0  1 -1 0  1 1 0  -1 1 0 ] \"normal N\" [ 0 0 1 0 0 1 0 0 1 "
    "0 0 1 ] "
    "\"integer indices\" [ 0 1 2 0 2 3 ]\n";

TEST(Leniency, AMeshScaledToZeroInOneAxisIsFlat) {
  // The square is flat before, so the scale changes nothing.
  const Outcome plain = Render(WithFilm("", kSquare));
  const Outcome flat = Render(WithFilm("", "Scale 1 1 0\n" + kSquare));
  EXPECT_EQ(flat.values, plain.values);
  EXPECT_THAT(flat.warnings, IsEmpty());
  const Outcome matrix =
      Render(WithFilm("", "ConcatTransform [ 1 0 0 0  0 1 0 0  0 0 0 0  0 0 0 1 ]\n" + kSquare));
  EXPECT_EQ(matrix.values, plain.values);
}

TEST(Leniency, OtherThingsScaledToZeroAreLeftOutWithAWarning) {
  const Outcome empty = Render(WithFilm("", ""));
  const std::string object = "ObjectBegin \"o\"\nShape \"sphere\"\nObjectEnd\n";
  for (const std::string& thing :
       {kBall, std::string("LightSource \"point\"\n"), object + "Scale 0 1 1 ObjectInstance \"o\"\n"}) {
    const Outcome flat = Render(WithFilm("", "AttributeBegin Scale 1 0 1\n" + thing + "AttributeEnd"));
    EXPECT_EQ(flat.values, empty.values) << thing;
    EXPECT_GE(flat.warnings.size(), 1u) << thing;
  }
}

TEST(Leniency, MotionThroughZeroLeavesOutWhatHasNoVolumeAtTheMoment) {
  const std::string mirrored = "ActiveTransform EndTime Scale -1 -1 -1 ActiveTransform All\n" + kBall;
  RenderOptions middle;
  middle.time = 0.5;
  const Outcome gone = Render(WithFilm("", mirrored), middle);
  EXPECT_EQ(gone.values, Render(WithFilm("", "")).values);
  EXPECT_THAT(gone.warnings,
              testing::Contains("a.pbrt:8:1: what moves here has no volume at 0.5 s and is not shown"));
  // What grows from nothing has half its size in the middle.
  const std::string growing = "ActiveTransform StartTime Scale 0 0 0 ActiveTransform All\n" + kBall;
  EXPECT_EQ(Render(WithFilm("", growing), middle).values,
            Render(WithFilm("", "Scale .5 .5 .5\n" + kBall)).values);
  RenderOptions start;
  start.time = 0;
  EXPECT_EQ(Render(WithFilm("", growing), start).values, gone.values);
}

TEST(Leniency, MeshesWithoutUsableIndicesAreLeftOutWithAWarning) {
  const Outcome empty = Render(WithFilm("", ""));
  for (const std::string mesh : {"", "\"point3 P\" [ 0 0 0 1 1 1 ]",
                                 "\"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]",
                                 "\"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 -1 2 ]"}) {
    const Outcome outcome = Render(WithFilm("", "Shape \"trianglemesh\" " + mesh));
    EXPECT_EQ(outcome.values, empty.values) << mesh;
    ASSERT_EQ(outcome.warnings.size(), 1u) << mesh;
    EXPECT_THAT(outcome.warnings[0], testing::HasSubstr("the trianglemesh is ignored")) << mesh;
  }
}

}  // namespace
}  // namespace tessera::leniency
