// Whole pictures of every camera, sensor and sampler.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "renderer/color/named_spectra.h"
#include "renderer/film/channel_layout.h"
#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera::camera_scenes {
namespace {

// f = 100 mm, with the stop at the lens.
const char* const kLens = "100 3 1.5 34\n-100 0.01 1 34\n0 0.01 0 34\n";

std::unique_ptr<Scene> Load(const std::string& text, const RenderOptions& options = {}) {
  MemoryFiles files({{"a.pbrt", text}, {"lens.dat", kLens}});
  Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "a.pbrt", options, Scene::Depth::kRender);
  EXPECT_TRUE(scene) << scene.error().message;
  return *std::move(scene);
}

std::vector<float> Render(const std::string& text, const RenderOptions& options = {}) {
  const std::unique_ptr<Scene> scene = Load(text, options);
  const FrameSpec& frame = scene->frame();
  Merger merger(frame);
  for (int tile = frame.TileCount() - 1; tile >= 0; --tile) {
    for (const SampleRange range : DyadicPartition(frame.samples_per_pixel))
      EXPECT_TRUE(merger.Add(tile, *scene->Render(frame.TileBounds(tile), {}, range, nullptr)));
  }
  return merger.Picture().values;
}

std::string Settings(const std::string& film, const std::string& camera, const std::string& sampler) {
  return "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16 \"bool savefp16\" false " +
         film + "\nPixelFilter \"box\"\nCamera " + camera + "\nSampler " + sampler +
         " \"integer pixelsamples\" 16\n";
}

const char* const kWorld = R"(
WorldBegin
LightSource "infinite" "rgb L" [ 0.3 0.4 0.6 ]
LightSource "point" "rgb I" [ 30 20 10 ] "point3 from" [ 2 3 -1 ]
Translate 0 0 4
Material "diffuse" "rgb reflectance" [ 0.7 0.5 0.2 ]
Shape "sphere"
Translate 0 -1 0 Rotate 90 1 0 0
Shape "disk" "float radius" 5
)";

const std::vector<std::string> kCameras = {
    R"("perspective" "float fov" 60)",
    R"("orthographic")",
    R"("spherical")",
    R"("spherical" "string mapping" "equirectangular")",
    R"("realistic" "string lensfile" "lens.dat" "float aperturediameter" 24 "float focusdistance" 4
       "string aperture" "star")",
};

TEST(CameraScenes, EveryCameraGivesTheSameBitsForAnyTileSize) {
  for (const std::string& camera : kCameras) {
    for (const char* sampler :
         {"\"halton\"", "\"halton\" \"string randomization\" \"owen\"", "\"pmj02bn\""}) {
      const std::string text = Settings("\"float diagonal\" 70", camera, sampler) + kWorld;
      RenderOptions small;
      small.tile_size = 5;
      const std::vector<float> whole = Render(text);
      EXPECT_EQ(whole, Render(text, small)) << camera << sampler;
      EXPECT_GT(*std::ranges::max_element(whole), 0.01f) << camera;
      EXPECT_LT(*std::ranges::min_element(whole), 0.9f * *std::ranges::max_element(whole)) << camera;
    }
  }
}

TEST(CameraScenes, EveryCameraSeesAnEvenSurroundingEvenly) {
  const std::string world = "WorldBegin\nLightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
  constexpr size_t kWidth = 24, kHeight = 16;
  for (size_t i = 0; i < 4; ++i) {
    const std::vector<float> picture = Render(Settings("", kCameras[i], "\"halton\"") + world);
    ASSERT_EQ(picture.size(), kWidth * kHeight * 3);
    // The noise is that of the wavelengths.
    double sum = 0;
    for (size_t x = 0; x < kWidth; ++x) {
      double column = 0;
      for (size_t y = 0; y < kHeight; ++y) column += picture[(y * kWidth + x) * 3 + 1] / double{kHeight};
      EXPECT_NEAR(column, 1, 0.1) << kCameras[i] << " column " << x;
      sum += column / double{kWidth};
    }
    EXPECT_NEAR(sum, 1, 0.01) << kCameras[i];
  }
}

TEST(CameraScenes, ARealisticCameraExposesTheFilmAsItsApertureSays) {
  // E = L pi sin^2 of the half angle of the cone of light, in the middle of the film.
  for (const float diameter : {10.0f, 24.0f}) {
    const std::string camera = "\"realistic\" \"string lensfile\" \"lens.dat\" \"float focusdistance\" 100 " +
                               std::string("\"float aperturediameter\" ") + std::to_string(diameter);
    const std::vector<float> picture = Render(Settings("\"float diagonal\" 5", camera, "\"pmj02bn\"") +
                                              "WorldBegin\nLightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n");
    double mean = 0;
    for (const float value : picture) mean += value / static_cast<double>(picture.size());
    const double radius = static_cast<double>(diameter) / 2000;
    const double expected = 3.14159265 * radius * radius / (radius * radius + 0.1 * 0.1);
    EXPECT_NEAR(mean / expected, 1, 0.03) << diameter;
  }
}

TEST(CameraScenes, PixelBoundsShowAPartOfTheSamePicture) {
  for (const char* sampler : {"\"halton\"", "\"pmj02bn\"", "\"independent\""}) {
    const std::vector<float> whole = Render(Settings("", kCameras[0], sampler) + kWorld);
    const std::string bounds = "\"integer pixelbounds\" [ 5 20 3 11 ]";
    const std::vector<float> part = Render(Settings(bounds, kCameras[0], sampler) + kWorld);
    ASSERT_EQ(part.size(), size_t{15 * 8 * 3});
    for (size_t y = 0; y < 8; ++y) {
      for (size_t i = 0; i < size_t{15 * 3}; ++i)
        ASSERT_EQ(part[y * 45 + i], whole[(y + 3) * 72 + 15 + i]) << sampler << " row " << y;
    }
  }
}

// The mean of each colour.
std::array<double, 3> MeanColour(const std::vector<float>& picture) {
  std::array<double, 3> mean{};
  for (size_t i = 0; i < picture.size(); ++i)
    mean[i % 3] += picture[i] * 3 / static_cast<double>(picture.size());
  return mean;
}

TEST(CameraScenes, SensorsShowAGreySurroundingInGrey) {
  const std::string world = "WorldBegin\nLightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n";
  for (const char* sensor : {"cie1931", "canon_eos_5d_mkiv", "hasselblad_l1d_20c", "sony_ilce_9"}) {
    const std::string film = std::string("\"string sensor\" \"") + sensor + "\" \"float iso\" 200";
    const auto mean = MeanColour(Render(Settings(film, kCameras[0], "\"halton\"") + world));
    for (const double colour : mean) EXPECT_NEAR(colour, 2, 0.08) << sensor;
  }
}

TEST(CameraScenes, AGbufferFilmHasTheColoursOfRgb) {
  const std::string rgb = Settings("", kCameras[0], "\"halton\"") + kWorld;
  std::string text = Settings("\"string coordinatesystem\" \"world\"", kCameras[0], "\"halton\"") + kWorld;
  text.replace(text.find("rgb"), 3, "gbuffer");
  const std::vector<float> all = Render(text), colours = Render(rgb);
  const size_t channels = all.size() * 3 / colours.size();
  EXPECT_EQ(channels, 25u);
  for (size_t i = 0; i < colours.size(); ++i) ASSERT_EQ(all[i / 3 * channels + i % 3], colours[i]);
}

TEST(CameraScenes, ASpectralFilmKeepsTheMeanRadianceOfEveryBucket) {
  // The radiance rises with the wavelength: 1 at 400 nm, 5 at 800 nm, times what makes its luminance 1.
  std::string text = Settings("\"integer nbuckets\" 4 \"float lambdamin\" 400 \"float lambdamax\" 800",
                              kCameras[0], "\"halton\"") +
                     "WorldBegin\nLightSource \"infinite\" \"spectrum L\" [ 400 1 800 5 ]\n";
  text.replace(text.find("rgb"), 3, "spectral");
  const std::unique_ptr<Scene> scene = Load(text);
  std::vector<std::string> names;
  for (const PictureChannel& channel : scene->frame().PictureChannels()) names.push_back(channel.name);
  EXPECT_EQ(names, (std::vector<std::string>{"R", "G", "B", "S0.450,000nm", "S0.550,000nm", "S0.650,000nm",
                                             "S0.750,000nm"}));
  EXPECT_EQ(scene->frame().attributes.at("spectralLayoutVersion"), "1.0");
  const std::vector<float> picture = Render(text);
  double bucket[4] = {}, luminance = 0;
  for (size_t i = 0; i < picture.size(); ++i) {
    if (i % 7 >= 3) bucket[i % 7 - 3] += picture[i] * 7 / static_cast<double>(picture.size());
  }
  for (int nm = 400; nm <= 800; ++nm)
    luminance += static_cast<double>(CieY()[static_cast<size_t>(nm - kLambdaMin)]) * (1 + (nm - 400) / 100.0);
  for (int i = 0; i < 4; ++i) {
    const double expected = (1.5 + i) * static_cast<double>(kCieYIntegral) / luminance;
    EXPECT_NEAR(bucket[i] / expected, 1, 0.03) << i;
  }
  // The colours are those of the film "rgb".
  std::string plain = text;
  plain.replace(plain.find("spectral"), 8, "rgb");
  for (const char* parameter :
       {"\"integer nbuckets\" 4", "\"float lambdamin\" 400", "\"float lambdamax\" 800"})
    plain.erase(plain.find(parameter), std::string(parameter).size());
  const std::vector<float> colours = Render(plain);
  for (size_t i = 0; i < colours.size(); ++i) ASSERT_EQ(colours[i], picture[i / 3 * 7 + i % 3]);
}

TEST(CameraScenes, UnknownSensorsAndSettingsAreRefusedWithTheirPlace) {
  const auto error = [](const std::string& film, const std::string& camera, const std::string& sampler) {
    MemoryFiles files({{"a.pbrt", Settings(film, camera, sampler) + kWorld}, {"lens.dat", kLens}});
    const auto scene = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kCheck);
    return scene ? "" : scene.error().message;
  };
  EXPECT_THAT(error("\"string sensor\" \"nikon_d85\"", kCameras[0], "\"halton\""),
              testing::AllOf(testing::HasSubstr("a.pbrt:1:"), testing::HasSubstr("nikon_d850")));
  EXPECT_THAT(error("\"float diagonal\" 0", kCameras[0], "\"halton\""), testing::HasSubstr("diagonal"));
  MemoryFiles files;
  files.files["a.pbrt"] = "Film \"spectral\" \"float lambdamin\" 200\nWorldBegin\n";
  EXPECT_FALSE(Scene::Load(files, "a.pbrt", {}, Scene::Depth::kCheck));
  const std::string narrow = "\"float lambdamin\" 550 \"float lambdamax\" 550.005";
  for (const std::string count : {"", " \"integer nbuckets\" 11"}) {
    files.files["a.pbrt"] = "Film \"spectral\" " + narrow + count + "\nWorldBegin\n";
    const auto scene = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kCheck);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, testing::StartsWith(count.empty() ? "a.pbrt:1:1: the 16 buckets"
                                                                         : "a.pbrt:1:65: the 11 buckets"));
  }
  EXPECT_THAT(error("", kCameras[0], "\"halton\" \"string randomization\" \"fastowen\""),
              testing::HasSubstr("fastowen"));
}

}  // namespace
}  // namespace tessera::camera_scenes
