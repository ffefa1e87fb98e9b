// The colour spaces of images that lights emit.
#include "renderer/util/file.h"
#include "tests/build_paths.h"
#include "tests/renderer/exr_bytes.h"
#include "tests/renderer/light/light_scene.h"

namespace tessera::light_images {
namespace {

constexpr Point2 kMiddle{0.5f, 0.5f};

// A light of each kind that emits an image, and before them a constant one of the same colour.
void BuildLights(LightScene& lights, const std::string& attributes, const std::string& color_space) {
  lights.files.files["image.exr"] = ExrOfOneColor(4, 0.8f, 0.3f, 0.1f, attributes);
  lights.Build("ColorSpace \"" + color_space + R"("
    LightSource "point" "rgb I" [ .8 .3 .1 ]
    ColorSpace "srgb"
    LightSource "infinite" "string filename" [ "image.exr" ]
    LightSource "projection" "string filename" [ "image.exr" ]
    LightSource "goniometric" "string filename" [ "image.exr" ]
    AreaLightSource "diffuse" "string filename" [ "image.exr" ]
    Shape "sphere")",
               {SphereShape({0, 0, 9}, 1)});
  ASSERT_EQ(lights.error, "");
}

// What arrives one unit along +z from the origin, nm by nm.
std::vector<float> SpectrumOf(const LightScene& lights, int light) {
  const ReferencePoint reference = At({0, 0, 1});
  std::vector<float> spectrum;
  for (int first = 0; first < kLambdaCount; first += 4) {
    const SampledWavelengths wavelengths = FourWavelengths(first);
    const bool is_infinite = light == 1;
    const auto sample = lights.table.Sample(light, reference, kMiddle, wavelengths);
    const SampledSpectrum L = is_infinite
                                  ? lights.table.InfiniteRadiance(light, {}, {0, 0, 1}, 0, wavelengths)
                              : sample ? sample->Radiance(wavelengths)
                                       : SampledSpectrum();
    for (int i = 0; i < 4 && first + i < kLambdaCount; ++i) spectrum.push_back(L[i]);
  }
  return spectrum;
}

void ExpectSame(const std::vector<float>& a, const std::vector<float>& b, const std::string& what) {
  float difference = 0, largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    largest = std::max(largest, a[i]);
  }
  EXPECT_GT(largest, 0) << what;
  EXPECT_LT(difference, 0.02f * largest) << what;
}

TEST(ImagesOfLights, AreEmittedInTheColorSpaceOfTheirFile) {
  for (const auto& [attributes, space] :
       {std::pair(std::string(), "srgb"), std::pair(ExrChromaticities(kRec2020Xy), "rec2020")}) {
    LightScene lights;
    BuildLights(lights, attributes, space);
    const std::vector<float> expected = SpectrumOf(lights, 0);
    for (const int light : {1, 2, 4}) {
      ExpectSame(SpectrumOf(lights, light), expected, std::string(space) + " light " + std::to_string(light));
    }
    EXPECT_TRUE(lights.diagnostics.warnings().empty());
  }
}

TEST(ImagesOfLights, OfGoniometricLightsOnlyScaleAsInPbrt) {
  LightScene plain, wide;
  BuildLights(plain, "", "srgb");
  BuildLights(wide, ExrChromaticities(kRec2020Xy), "rec2020");
  EXPECT_EQ(SpectrumOf(plain, 3), SpectrumOf(wide, 3));
}

TEST(ImagesOfLights, OfAnUnknownColorSpaceAreSrgbWithAWarning) {
  LightScene plain, adobe;
  BuildLights(plain, "", "srgb");
  BuildLights(adobe, ExrChromaticities(kAdobeRgbXy), "srgb");
  for (const int light : {1, 2, 4}) EXPECT_EQ(SpectrumOf(plain, light), SpectrumOf(adobe, light));
  ASSERT_EQ(adobe.diagnostics.warnings().size(), 3u);  // of the goniometric light nothing changes
  EXPECT_EQ(
      adobe.diagnostics.warnings()[0].Text(),
      "lights.pbrt:6:28: the image has the chromaticities red 0.64 0.33, green 0.21 0.71, blue 0.15 0.06, "
      "white 0.3127 0.329, which are those of none of the supported colour spaces; it is read as sRGB");
}

// The same picture of 7 x 5 pixels in each of them, or a smaller one.
TEST(ImagesOfLights, AreReadFromEveryFormat) {
  for (const std::string name : {"png/3.png", "jpeg/3.jpg", "bmp/3.bmp", "webp/3.webp", "tiff/3.tif",
                                 "hdr/3.hdr", "tga/3.tga", "exr/4.exr", "qoi/all.qoi", "pfm/rgb.pfm"}) {
    const Result<std::string> bytes = ReadFile(SourceDir() + "/tests/fuzz/corpus/" + name, size_t{1} << 20);
    ASSERT_TRUE(bytes) << bytes.error().message;
    LightScene lights;
    lights.files.files[name] = *bytes;
    lights.Build("LightSource \"projection\" \"string filename\" \"" + name + R"("
      AreaLightSource "diffuse" "string filename" ")" +
                     name + "\"\nShape \"sphere\"",
                 {SphereShape({0, 0, 9}, 1)});
    ASSERT_EQ(lights.error, "") << name;
    TestRandom random(1);
    float projected = 0, emitted = 0;
    for (int i = 0; i < 100; ++i) {
      const Point2 u = random.Next2<Point2>();
      projected += SampleLuminance(lights.table, 0, At({u.x - 0.5f, u.y - 0.5f, 1}), u);
      emitted += SampleLuminance(lights.table, 1, At({0, 0, 0}), u);
    }
    EXPECT_GT(projected, 0) << name;
    EXPECT_GT(emitted, 0) << name;
    // Only its shape stands in the way of a goniometric light.
    LightScene gonio;
    gonio.files.files[name] = *bytes;
    gonio.Build("LightSource \"goniometric\" \"string filename\" \"" + name + "\"");
    const bool is_accepted = gonio.error.empty();
    EXPECT_TRUE(is_accepted || gonio.error.find("is not square") != std::string::npos) << gonio.error;
  }
}

TEST(ImagesOfLights, AreScannedOnceForAllShapesThatEmitThem) {
  LightScene lights;
  lights.files.files["image.exr"] = ExrOfOneColor(4, 0.8f, 0.3f, 0.1f, "");
  constexpr int kShapes = 20;
  std::string text;
  std::vector<Shape> shapes;
  for (int i = 0; i < kShapes; ++i) {
    text += "AreaLightSource \"diffuse\" \"string filename\" \"image.exr\" \"float scale\" " +
            std::to_string(i + 1) + " Shape \"sphere\"\n";
    shapes.push_back(SphereShape({0, 0, 3.0f * static_cast<float>(i)}, 1));
  }
  lights.Build(text + "LightSource \"projection\" \"string filename\" \"image.exr\"\n", shapes);
  ASSERT_EQ(lights.error, "");
  EXPECT_EQ(lights.images.summaries(), 1u);
}

}  // namespace
}  // namespace tessera::light_images
