#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "renderer/texture/patterns.h"
#include "tests/renderer/texture/texture_scene.h"

namespace tessera {
namespace {

// The value of the float texture "t" of these directives.
float FloatOf(const std::string& textures, const TextureContext& context,
              std::map<std::string, std::string> files = {}) {
  TextureScene scene(std::move(files));
  EXPECT_EQ(scene.Build(textures, "\"texture a\" \"t\""), "");
  const FloatInput input = scene.FloatInputOf("a");
  EXPECT_EQ(scene.error(), "");
  return scene.Finish().Evaluate(input, context);
}

// The mean over four wavelengths of the spectrum texture "t".
float SpectrumOf(const std::string& textures, const TextureContext& context, SpectrumUse use,
                 std::map<std::string, std::string> files = {}) {
  TextureScene scene(std::move(files));
  EXPECT_EQ(scene.Build(textures, "\"texture a\" \"t\""), "");
  const SpectrumInput input = scene.SpectrumInputOf("a", use);
  EXPECT_EQ(scene.error(), "");
  return Average(scene.Finish().Evaluate(input, context, SampledWavelengths::SampleVisible(0.3f)));
}

std::string ErrorOf(const std::string& textures, std::map<std::string, std::string> files = {}) {
  return TextureScene(std::move(files)).Build(textures);
}

const std::string kUsesPicture = "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.pfm\" ";
const std::map<std::string, std::string> kPicture{{"a.pfm", FloatMap(2, 2, {1, 2, 3, 4})}};

TEST(TextureBuilder, ConstantsNeedNoNode) {
  TextureScene scene;
  ASSERT_EQ(scene.Build(R"(Texture "c" "float" "constant" "float value" 0.25
                           Texture "t" "float" "scale" "texture tex" "c" "float scale" 2
                           Texture "m" "float" "mix" "texture tex1" "t" "float tex2" 1 "float amount" 0.5
                           Texture "s" "spectrum" "constant" "rgb value" [0.5 0.5 0.5]
                           Texture "ss" "spectrum" "scale" "texture tex" "s" "texture scale" "c")",
                        R"("texture a" "t" "texture b" "m" "texture c" "ss" "float d" 3)"),
            "");
  EXPECT_TRUE(scene.FloatInputOf("a").IsConstant());
  EXPECT_EQ(scene.FloatInputOf("a").constant, 0.5f);
  EXPECT_EQ(scene.FloatInputOf("b").constant, 0.75f);
  EXPECT_EQ(scene.FloatInputOf("d").constant, 3);
  EXPECT_EQ(scene.FloatInputOf("absent").constant, -1);
  ASSERT_TRUE(scene.SpectrumInputOf("c").IsConstant());
  EXPECT_NEAR(scene.SpectrumInputOf("c").constant.At(550), 0.125f, 1e-3f);
}

TEST(TextureBuilder, MixBlendsByItsAmount) {
  const std::string mix = R"(Texture "c" "float" "checkerboard"
      Texture "t" "float" "mix" "float tex1" 10 "float tex2" 20 "texture amount" "c")";
  EXPECT_EQ(FloatOf(mix, ContextAtUv(0.5f, 0.5f)), 20);
  EXPECT_EQ(FloatOf(mix, ContextAtUv(1.5f, 0.5f)), 10);
  const std::string spectrum =
      R"(Texture "t" "spectrum" "mix" "rgb tex1" [0.2 0.2 0.2] "rgb tex2" [0.4 0.4 0.4]
                                  "float amount" 0.25)";
  EXPECT_NEAR(SpectrumOf(spectrum, ContextAtUv(0, 0), SpectrumUse::kAlbedo), 0.25f, 1e-4f);
}

TEST(TextureBuilder, DirectionMixFollowsTheNormal) {
  const std::string mix = R"(Rotate 90 1 0 0
      Texture "t" "float" "directionmix" "float tex1" 10 "float tex2" 20)";  // y becomes z
  TextureContext context = ContextAtUv(0, 0);
  context.n = {0, 0, -1};
  EXPECT_NEAR(FloatOf(mix, context), 10, 1e-5f);
  context.n = {1, 0, 0};
  EXPECT_NEAR(FloatOf(mix, context), 20, 1e-5f);
}

TEST(TextureBuilder, BilerpHasTheValuesOfItsCorners) {
  const std::string bilerp =
      R"(Texture "t" "float" "bilerp" "float v00" 1 "float v01" 2 "float v10" 3 "float v11" 4)";
  EXPECT_EQ(FloatOf(bilerp, ContextAtUv(0, 0)), 1);
  EXPECT_EQ(FloatOf(bilerp, ContextAtUv(0, 1)), 2);
  EXPECT_EQ(FloatOf(bilerp, ContextAtUv(1, 0)), 3);
  EXPECT_EQ(FloatOf(bilerp, ContextAtUv(0.5f, 0.5f)), 2.5f);
}

TEST(TextureBuilder, CheckerboardTakesItsCoordinatesFromUvOrSpace) {
  const std::string flat =
      R"(Texture "t" "float" "checkerboard" "float uscale" 2 "float tex1" 5 "float tex2" 6)";
  EXPECT_EQ(FloatOf(flat, ContextAtUv(0.3f, 0.3f)), 5);
  EXPECT_EQ(FloatOf(flat, ContextAtUv(0.7f, 0.3f)), 6);
  const std::string solid = R"(Scale 10 10 10
      Texture "t" "float" "checkerboard" "integer dimension" 3 "float tex1" 5 "float tex2" 6)";
  TextureContext context = ContextAtUv(0, 0);
  context.p = {5, 5, 5};
  EXPECT_EQ(FloatOf(solid, context), 5);
  context.p = {5, 5, 15};
  EXPECT_EQ(FloatOf(solid, context), 6);
}

TEST(TextureBuilder, RenderingSpaceIsUndoneBeforeTheTexturesOwnSpace) {
  TextureScene scene;
  scene.render_from_world = Translate({100, 0, 0});
  ASSERT_EQ(scene.Build(R"(Translate 0 1000 0
      Texture "t" "float" "bilerp" "string mapping" "planar" "float v10" 1 "float v01" 0)",
                        R"("texture a" "t")"),
            "");
  const FloatInput input = scene.FloatInputOf("a");
  const TextureTable table = scene.Finish();
  TextureContext context;
  context.p = {100.25f, 1000, 0};  // in the texture's space: (0.25, 0, 0)
  EXPECT_NEAR(table.Evaluate(input, context), 0.25f, 1e-4f);
}

TEST(TextureBuilder, ImagesHaveTheirFirstRowAtTheTop) {
  const auto at = [](float u, float v) {
    return FloatOf(kUsesPicture + "\"string filter\" \"point\"", ContextAtUv(u, v), kPicture);
  };
  EXPECT_EQ(at(0.25f, 0.75f), 1);
  EXPECT_EQ(at(0.75f, 0.75f), 2);
  EXPECT_EQ(at(0.25f, 0.25f), 3);
  EXPECT_EQ(at(0.75f, 0.25f), 4);
}

TEST(TextureBuilder, ImagesAreScaledThenInverted) {
  EXPECT_FLOAT_EQ(FloatOf(kUsesPicture + "\"float scale\" 0.25", ContextAtUv(0.25f, 0.75f), kPicture), 0.25f);
  const std::string inverted = kUsesPicture + "\"float scale\" 0.25 \"bool invert\" true";
  EXPECT_FLOAT_EQ(FloatOf(inverted, ContextAtUv(0.25f, 0.75f), kPicture), 0.75f);
  EXPECT_FLOAT_EQ(FloatOf(kUsesPicture + "\"bool invert\" true", ContextAtUv(0.75f, 0.25f), kPicture), 0);
}

TEST(TextureBuilder, ScalingAnImageByAConstantChangesItsOwnScaleAsInPbrt) {
  const std::string scaled =
      "Texture \"i\" \"float\" \"imagemap\" \"string filename\" \"a.pfm\" \"bool invert\" true\n"
      "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"i\" \"float scale\" 0.5";
  EXPECT_FLOAT_EQ(FloatOf(scaled, ContextAtUv(0.25f, 0.75f), kPicture),
                  0.5f);  // 1 - 0.5 * 1, not 0.5 * (1 - 1)
  const std::string other_way =
      "Texture \"i\" \"float\" \"imagemap\" \"string filename\" \"a.pfm\"\n"
      "Texture \"t\" \"float\" \"scale\" \"float tex\" 0.5 \"texture scale\" \"i\"";
  EXPECT_FLOAT_EQ(FloatOf(other_way, ContextAtUv(0.75f, 0.75f), kPicture), 1);
}

TEST(TextureBuilder, FloatTextureOfAColorImageIsItsMean) {
  const std::map<std::string, std::string> files{{"a.pfm", FloatMap(1, 1, {0.25f, 0.5f, 1.5f})}};
  EXPECT_FLOAT_EQ(FloatOf(kUsesPicture, ContextAtUv(0, 0), files), 0.75f);
  EXPECT_FLOAT_EQ(FloatOf(kUsesPicture + "\"string filter\" \"ewa\"", ContextAtUv(0, 0), files), 0.25f);
}

TEST(TextureBuilder, SpectrumImagesDependOnTheirUse) {
  const std::string picture = R"(Texture "t" "spectrum" "imagemap" "string filename" "a.pfm")";
  const std::map<std::string, std::string> files{{"a.pfm", FloatMap(1, 1, {3, 3, 3})}};
  const TextureContext context = ContextAtUv(0.5f, 0.5f);
  EXPECT_NEAR(SpectrumOf(picture, context, SpectrumUse::kAlbedo, files), 1, 1e-3f);
  EXPECT_NEAR(SpectrumOf(picture, context, SpectrumUse::kUnbounded, files), 3, 1e-2f);
  const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(0.3f);
  const float white = Average(SampleTable(*ColorSpace::Srgb().illuminant(), wavelengths));
  EXPECT_NEAR(SpectrumOf(picture, context, SpectrumUse::kIlluminant, files) / (3 * white), 1, 1e-2f);
}

TEST(TextureBuilder, ColorImageEqualsTheSameColorAsConstant) {
  TextureScene scene({{"a.pfm", FloatMap(1, 1, {0.8f, 0.3f, 0.1f})}});
  ASSERT_EQ(scene.Build(R"(Texture "t" "spectrum" "imagemap" "string filename" "a.pfm")",
                        R"("texture a" "t" "rgb b" [0.8 0.3 0.1])"),
            "");
  const SpectrumInput image = scene.SpectrumInputOf("a"), constant = scene.SpectrumInputOf("b");
  EXPECT_FALSE(image.IsConstant());
  const TextureTable table = scene.Finish();
  const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(0.6f);
  const SampledSpectrum a = table.Evaluate(image, ContextAtUv(0, 0), wavelengths);
  const SampledSpectrum b = table.Evaluate(constant, ContextAtUv(0, 0), wavelengths);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(a[i], b[i], 2e-3f);
}

TEST(TextureBuilder, ImagesAreKeptOnceForAllTexturesThatUseThem) {
  TextureScene scene(kPicture);
  std::string textures;
  for (const std::string name : {"a", "b", "c"}) {
    textures += "Texture \"" + name +
                "\" \"float\" \"imagemap\" \"string filename\" \"a.pfm\" \"float uscale\" " +
                std::to_string(name[0] - 'a' + 1) + "\n";
    textures += "Texture \"" + name + "\" \"spectrum\" \"imagemap\" \"string filename\" \"a.pfm\"\n";
  }
  ASSERT_EQ(scene.Build(textures), "");
  EXPECT_EQ(scene.Finish().bytes(), 5 * sizeof(float) + 16);  // 2x2 and 1x1 texels, and room for one load
}

// A QOI picture of 1024 x 1024 pixels of one colour: one pixel, and runs of 62 that repeat it.
std::string LargePicture() {
  std::string file = std::string("qoif\0\0\4\0\0\0\4\0\4\0", 14) + "\xff\x20\x40\x60\xff";
  for (int left = 1024 * 1024 - 1; left > 0; left -= 62)
    file += static_cast<char>(0xc0 | (std::min(left, 62) - 1));
  return file + std::string("\0\0\0\0\0\0\0\1", 8);
}

TEST(TextureBuilder, MapsThatAreRecalledCountInTheLimitOfPictures) {
  const std::string texture = R"(Texture "t" "spectrum" "imagemap" "string filename" "a.qoi")";
  const auto cache = std::make_shared<SharedCache>(uint64_t{64} << 20);
  TextureScene first({{"a.qoi", LargePicture()}}, cache);
  ASSERT_EQ(first.Build(texture), "");
  ASSERT_GT(cache->bytes(), uint64_t{8} << 20) << "the picture and a map of it are kept";
  TextureScene second({{"a.qoi", LargePicture()}}, cache, 0);
  EXPECT_THAT(second.Build(texture),
              testing::HasSubstr("a.qoi: the pictures up to this one hold 4194304 bytes"));
}

TEST(TextureBuilder, ProceduralsAreEvaluatedInTheTexturesSpace) {
  TextureContext context = ContextAtUv(0, 0);
  context.p = {0.3f, 0.6f, 0.2f};
  context.dpdx = context.dpdy = {0.001f, 0, 0};
  for (const std::string kind : {"fbm", "wrinkled", "windy"}) {
    const std::string texture = "Texture \"t\" \"float\" \"" + kind + "\"";
    TextureContext larger = context;
    larger.p = larger.p * 8;
    larger.dpdx = larger.dpdx * 8;
    larger.dpdy = larger.dpdy * 8;
    const float value = FloatOf(texture, context);
    EXPECT_NE(value, 0);
    EXPECT_FLOAT_EQ(FloatOf("Scale 8 8 8 " + texture, larger), value) << kind;
  }
  const float marble = SpectrumOf(R"(Texture "t" "spectrum" "marble")", context, SpectrumUse::kAlbedo);
  EXPECT_GT(marble, 0.2f);
  EXPECT_LT(marble, 0.92f);
}

TEST(TextureBuilder, DotsArePaintedAsInPbrtWithInsideAndOutsideSwapped) {
  const std::string dots = R"(Texture "t" "float" "dots" "float inside" 5 "float outside" 6)";
  int inside = 0;
  for (int i = 0; i < 400; ++i) {
    const Point2 st{0.37f * static_cast<float>(i % 20), 0.37f * static_cast<float>(i / 20)};
    const float expected = InsideDot(st) ? 6 : 5;
    inside += InsideDot(st);
    EXPECT_EQ(FloatOf(dots, ContextAtUv(st.x, st.y)), expected);
  }
  EXPECT_GT(inside, 20);
}

TEST(TextureBuilder, FloatAndSpectrumTexturesHaveSeparateNames) {
  TextureScene scene;
  ASSERT_EQ(scene.Build(R"(Texture "t" "float" "constant" "float value" 2
                           Texture "t" "spectrum" "constant" "rgb value" [0.5 0.5 0.5])",
                        R"("texture a" "t")"),
            "");
  EXPECT_EQ(scene.FloatInputOf("a").constant, 2);
  EXPECT_NEAR(scene.SpectrumInputOf("a").constant.At(500), 0.5f, 1e-3f);
}

TEST(TextureBuilder, AlbedoAboveOneIsAnErrorOnlyWhereAnAlbedoIsExpected) {
  TextureScene scene;
  ASSERT_EQ(scene.Build(R"(Texture "t" "spectrum" "constant" "rgb value" [2 2 2])", R"("texture a" "t")"),
            "");
  EXPECT_NEAR(scene.SpectrumInputOf("a", SpectrumUse::kUnbounded).constant.At(500), 2, 1e-2f);
  EXPECT_EQ(scene.error(), "");
  scene.SpectrumInputOf("a", SpectrumUse::kAlbedo);
  EXPECT_THAT(scene.error(), testing::StartsWith("a.pbrt:2:35: "));
}

TEST(TextureErrors, NameTheirPlaceAndSuggestNames) {
  TextureScene scene;
  ASSERT_EQ(scene.Build(R"(Texture "wood" "spectrum" "constant"
Texture "bump" "float" "constant")",
                        R"("texture a" "wod" "texture b" "bump" "texture c" "wood")"),
            "");
  scene.SpectrumInputOf("a");
  EXPECT_EQ(scene.error(), "a.pbrt:4:20: unknown spectrum texture \"wod\" (did you mean \"wood\"?)");
  scene.SpectrumInputOf("b");
  EXPECT_EQ(scene.error(), "a.pbrt:4:38: texture \"bump\" is a float texture, expected a spectrum texture");
  scene.FloatInputOf("c");
  EXPECT_EQ(scene.error(), "a.pbrt:4:57: texture \"wood\" is a spectrum texture, expected a float texture");
}

TEST(TextureErrors, AreReportedWhenTexturesAreAdded) {
  EXPECT_EQ(ErrorOf(R"(Texture "t" "float" "imagmap")"),
            "a.pbrt:2:1: unknown float texture \"imagmap\" (did you mean \"imagemap\"?)");
  EXPECT_EQ(ErrorOf(R"(Texture "t" "spectrum" "ptex" "string filename" "a.ptx")"),
            "a.pbrt:2:1: spectrum texture \"ptex\" is not supported yet");
  EXPECT_EQ(ErrorOf(R"(Texture "t" "float" "scale" "texture tex" "u")"),
            "a.pbrt:2:29: unknown float texture \"u\"");
  EXPECT_EQ(ErrorOf(R"(Texture "t" "spectrum" "scale" "texture tex" "t")"),
            "a.pbrt:2:32: unknown spectrum texture \"t\"");
  EXPECT_THAT(ErrorOf(R"(Texture "t" "float" "constant" Texture "t" "float" "constant")"),
              testing::StartsWith("a.pbrt:2:32: float texture \"t\" is defined twice"));
  EXPECT_EQ(ErrorOf(R"(Texture "t" "float" "checkerboard" "integer dimension" 4)"),
            "a.pbrt:2:36: dimension is 4, expected 2 or 3");
  EXPECT_EQ(ErrorOf(R"(Texture "t" "float" "fbm" "integer octaves" 1000)"),
            "a.pbrt:2:27: octaves is 1000, expected 0 to 64");
  EXPECT_EQ(ErrorOf(R"(Texture "t" "float" "directionmix" "vector3 dir" [0 0 0])"),
            "a.pbrt:2:36: dir is zero, expected a direction");
  EXPECT_THAT(ErrorOf(R"(Texture "t" "float" "constant" "float valu" 1)"),
              testing::StartsWith("a.pbrt:2:32: unknown parameter \"float valu\" of Texture \"constant\""));
}

TEST(TextureErrors, OfImagesNameTheFile) {
  EXPECT_EQ(ErrorOf(R"(Texture "t" "float" "imagemap")"),
            "a.pbrt:2:1: texture \"imagemap\" needs a parameter \"string filename\"");
  EXPECT_EQ(ErrorOf(R"(Texture "t" "spectrum" "imagemap" "string filename" "textures/x.png")"),
            "a.pbrt:2:35: textures/x.png: cannot be opened: No such file or directory");
  EXPECT_EQ(ErrorOf(R"(Texture "t" "spectrum" "imagemap" "string filename" "x.png")", {{"x.png", "junk"}}),
            "a.pbrt:2:35: x.png: damaged picture: it does not begin as a PNG file does");
  EXPECT_EQ(
      ErrorOf(kUsesPicture + "\"string encoding\" \"gamma x\"", kPicture),
      "a.pbrt:2:58: unknown encoding \"gamma x\", expected \"linear\", \"sRGB\" or \"gamma\" and a number");
  EXPECT_THAT(ErrorOf(kUsesPicture + "\"string wrap\" \"mirror\"", kPicture),
              testing::HasSubstr("\"repeat\", \"black\", \"clamp\", \"octahedralsphere\""));
  EXPECT_EQ(ErrorOf(kUsesPicture + "\"float maxanisotropy\" 0.5", kPicture),
            "a.pbrt:2:58: maxanisotropy is 0.5, expected at least 1");
}

TEST(TextureErrors, ChainThatDoublesIsRefusedBeforeItIsEvaluated) {
  std::string textures = "Texture \"t0\" \"float\" \"checkerboard\"\n";
  for (int i = 1; i < 40; ++i) {
    const std::string before = "\"t" + std::to_string(i - 1) + "\"";
    textures += "Texture \"t" + std::to_string(i) + "\" \"float\" \"checkerboard\" \"texture tex1\" " +
                before + " \"texture tex2\" " + before + "\n";
  }
  EXPECT_EQ(
      ErrorOf(textures),
      "a.pbrt:14:1: textures refer to each other too deeply: at most 64 within another and 4096 in all");
}

}  // namespace
}  // namespace tessera
