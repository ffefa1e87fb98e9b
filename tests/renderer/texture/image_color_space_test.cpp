// Spectrum textures of images that name their colour space.
#include <gtest/gtest.h>

#include "tests/renderer/exr_bytes.h"
#include "tests/renderer/texture/texture_scene.h"

namespace tessera::image_color_space {
namespace {

const std::string kTexture = R"(Texture "t" "spectrum" "imagemap" "string filename" "a.exr")";

SampledSpectrum Value(TextureScene& scene, SpectrumUse use, const std::string& space) {
  EXPECT_EQ(
      scene.Build(kTexture + "\nColorSpace \"" + space + "\"", R"("texture a" "t" "rgb b" [ .6 .2 .1 ])"),
      "");
  const SpectrumInput a = scene.SpectrumInputOf("a", use);
  const TextureTable table = scene.Finish();
  return table.Evaluate(a, ContextAtUv(0.5f, 0.5f), SampledWavelengths::SampleVisible(0.3f));
}

SampledSpectrum Constant(TextureScene& scene, SpectrumUse use) {
  const SpectrumInput b = scene.SpectrumInputOf("b", use);
  return b.constant.Sample(SampledWavelengths::SampleVisible(0.3f));
}

TEST(ImageColorSpace, OfAnImageEqualsThatOfAConstant) {
  for (const auto& [attributes, space] :
       {std::pair(std::string(), "srgb"), std::pair(ExrChromaticities(kRec709Xy), "srgb"),
        std::pair(ExrChromaticities(kRec2020Xy), "rec2020")}) {
    for (const SpectrumUse use : {SpectrumUse::kAlbedo, SpectrumUse::kUnbounded, SpectrumUse::kIlluminant}) {
      TextureScene scene({{"a.exr", ExrOfOneColor(2, .6f, .2f, .1f, attributes)}});
      const SampledSpectrum value = Value(scene, use, space), constant = Constant(scene, use);
      for (int i = 0; i < 4; ++i) EXPECT_NEAR(value[i], constant[i], 0.01f * constant[i]) << space;
      EXPECT_TRUE(scene.diagnostics().warnings().empty());
    }
  }
}

TEST(ImageColorSpace, ThatIsUnknownIsSrgbWithAWarning) {
  const auto value = [](const std::string& attributes, size_t warnings) {
    TextureScene scene({{"a.exr", ExrOfOneColor(2, .6f, .2f, .1f, attributes)}});
    const SampledSpectrum result = Value(scene, SpectrumUse::kAlbedo, "srgb");
    EXPECT_EQ(scene.diagnostics().warnings().size(), warnings);
    return result;
  };
  const SampledSpectrum plain = value("", 0), adobe = value(ExrChromaticities(kAdobeRgbXy), 1);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(plain[i], adobe[i]);
}

TEST(ImageColorSpace, EveryColorSpaceIsRecognisedByItsChromaticities) {
  const auto match = [](const std::array<float, 8>& xy) {
    return ColorSpace::Matching({xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]});
  };
  EXPECT_EQ(match(kRec709Xy), &ColorSpace::Srgb());
  EXPECT_EQ(match(kRec2020Xy), ColorSpace::Named("rec2020"));
  EXPECT_EQ(match({.68f, .32f, .265f, .69f, .15f, .06f, .3127f, .329f}), ColorSpace::Named("dci-p3"));
  EXPECT_EQ(match({.7347f, .2653f, 0, 1, .0001f, -.077f, .32168f, .33767f}), ColorSpace::Named("aces2065-1"));
  EXPECT_EQ(match(kAdobeRgbXy), nullptr);
  // Rec. 709 with another white.
  EXPECT_EQ(match({.64f, .33f, .3f, .6f, .15f, .06f, .3457f, .3585f}), nullptr);
}

}  // namespace
}  // namespace tessera::image_color_space
