// The Option directives that change pictures, and integrators that are replaced.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera::scene_options {
namespace {

struct Outcome {
  std::vector<std::string> warnings;
  std::vector<float> values;  // of the picture
};

const std::string kChecker("Pf\n2 2\n-1.0\n\0\0\0\0\0\0\x80\x3f\0\0\x80\x3f\0\0\0\0", 28);

// `settings` come before, `world` after WorldBegin of a picture of 8 x 8 pixels.
Outcome Render(const std::string& settings, const std::string& world, const RenderOptions& overrides = {}) {
  MemoryFiles files(
      {{"a.pbrt",
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 \"bool savefp16\" false\n"
        "Camera \"perspective\"\nSampler \"independent\" \"integer pixelsamples\" 64\n" +
            settings + "\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n" + world},
       {"checker.pfm", kChecker}});
  const Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "a.pbrt", overrides, Scene::Depth::kRender);
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  const FrameSpec& frame = (*scene)->frame();
  Merger merger(frame);
  for (int tile = 0; tile < frame.TileCount(); ++tile) {
    for (const SampleRange range : DyadicPartition(frame.samples_per_pixel))
      EXPECT_TRUE(merger.Add(tile, *(*scene)->Render(frame.TileBounds(tile), {}, range, nullptr)));
  }
  return {(*scene)->summary().warnings, merger.Picture().values};
}

double MeanOf(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// The edge of a black half-plane runs through the middle of the pixels of column 4.
constexpr const char* kEdge = R"(
  Material "diffuse" "rgb reflectance" [ 0 0 0 ]
  Translate 0.125 0 1
  Shape "trianglemesh" "point3 P" [ 0.005 -9 0  9 -9 0  9 9 0  0.005 9 0 ] "integer indices" [ 0 1 2 0 2 3 ])";

TEST(Options, DisablePixelJitterPutsSamplesAtPixelCentres) {
  const Outcome jittered = Render("PixelFilter \"box\"", kEdge);
  const Outcome centred = Render("PixelFilter \"box\" Option \"disablepixeljitter\" true", kEdge);
  EXPECT_THAT(centred.warnings, testing::IsEmpty());
  const size_t channels = jittered.values.size() / 64;
  const float at_edge = jittered.values[4 * channels];
  EXPECT_GT(at_edge, 0.1f);
  EXPECT_LT(at_edge, 0.9f);
  EXPECT_NEAR(centred.values[4 * channels], 1, 0.1f);
  EXPECT_EQ(centred.values[5 * channels], 0);
}

TEST(Options, DisableWavelengthJitterGivesAllSamplesTheSameWavelengths) {
  const Outcome fixed = Render("Option \"disablewavelengthjitter\" true", "");
  EXPECT_THAT(fixed.warnings, testing::IsEmpty());
  for (size_t i = 3; i < fixed.values.size(); i += 3) EXPECT_NEAR(fixed.values[i], fixed.values[0], 1e-4f);
  const Outcome jittered = Render("", "");
  EXPECT_GT(std::abs(jittered.values[3] - jittered.values[0]), 1e-4f);
}

TEST(Options, DisableTextureFilteringLooksTexturesUpAtPoints) {
  // A fine checkerboard far away: filtered it is grey.
  const std::string far_checker = R"(
    Texture "c" "spectrum" "imagemap" "string filename" "checker.pfm" "float uscale" 500 "float vscale" 500
    "string filter" "trilinear"
    Material "diffuse" "texture reflectance" "c"
    Translate 0 0 9
    Shape "bilinearmesh" "point3 P" [ -40 -40 0  40 -40 0  -40 40 0  40 40 0 ])";
  const auto contrast = [&](const std::string& option) {
    MemoryFiles files(
        {{"a.pbrt",
          "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nCamera \"perspective\"\n"
          "Sampler \"zsobol\" \"integer pixelsamples\" 1\n" +
              option + "\nWorldBegin\nLightSource \"infinite\"\n" + far_checker},
         {"checker.pfm", kChecker}});
    const Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kRender);
    EXPECT_TRUE(scene) << scene.error().message;
    if (!scene) return 0.0;
    const RadianceTile tile = *(*scene)->Render({0, 0, 8, 8}, {}, {0, 1}, nullptr, nullptr);
    double low = 1e9, high = 0;
    for (size_t i = 0; i < 64; ++i) {
      low = std::min(low, static_cast<double>(tile.sums[i * 4 + 1]));
      high = std::max(high, static_cast<double>(tile.sums[i * 4 + 1]));
    }
    return high - low;
  };
  EXPECT_LT(contrast(""), 0.3);
  EXPECT_GT(contrast("Option \"disabletexturefiltering\" true"), 0.6);
}

TEST(Options, DisableImageTexturesShowsTheMeanOfImages) {
  const auto wall = [](const std::string& reflectance) {
    return R"(
      Texture "c" "spectrum" "imagemap" "string filename" "checker.pfm" "float uscale" 2 "string wrap" "black"
      Material "diffuse" )" +
           reflectance + R"(
      Shape "bilinearmesh" "point3 P" [ -9 -9 1  9 -9 1  -9 9 1  9 9 1 ])";
  };
  RenderOptions averaged;
  averaged.disable_image_textures = true;
  const std::vector<float> mean = Render("", wall("\"texture reflectance\" \"c\""), averaged).values;
  const std::vector<float> plain = Render("", wall("\"rgb reflectance\" [ 0.5 0.5 0.5 ]")).values;
  ASSERT_EQ(mean.size(), plain.size());
  for (size_t i = 0; i < mean.size(); ++i) EXPECT_NEAR(mean[i], plain[i], 2e-3f);
  EXPECT_NE(Render("", wall("\"texture reflectance\" \"c\"")).values, mean);
}

TEST(Options, ForceDiffuseKeepsTheAlbedoOfMaterials) {
  const std::string wall = R"(
    Material "conductor" "rgb reflectance" [ 0.6 0.6 0.6 ] "float roughness" 0.02
    Shape "bilinearmesh" "point3 P" [ -9 -9 1  9 -9 1  -9 9 1  9 9 1 ])";
  const Outcome diffuse = Render("Option \"forcediffuse\" true", wall), metal = Render("", wall);
  EXPECT_THAT(diffuse.warnings, testing::IsEmpty());
  // Under uniform light both show their albedo.
  EXPECT_NEAR(MeanOf(diffuse.values), MeanOf(metal.values), 0.05);
  EXPECT_NE(diffuse.values, metal.values);
}

// Each switch of the command line gives the bits of the option of the scene.
TEST(Options, TheCommandLineSwitchesThemOn) {
  const std::string world = R"(
    Texture "c" "spectrum" "checkerboard" "float uscale" 50 "float vscale" 50
    Material "conductor" "texture reflectance" "c" "float roughness" 0.1
    Shape "bilinearmesh" "point3 P" [ -9 -9 2  9 -9 2  -9 9 2  9 9 2 ])";
  const std::pair<const char*, bool RenderOptions::*> switches[] = {
      {"disablepixeljitter", &RenderOptions::disable_pixel_jitter},
      {"disablewavelengthjitter", &RenderOptions::disable_wavelength_jitter},
      {"disabletexturefiltering", &RenderOptions::disable_texture_filtering},
      {"forcediffuse", &RenderOptions::force_diffuse}};
  const std::vector<float> plain = Render("", world).values;
  for (const auto& [name, member] : switches) {
    RenderOptions overrides;
    overrides.*member = true;
    const std::vector<float> switched = Render("", world, overrides).values;
    EXPECT_EQ(switched, Render(fmt::format("Option \"{}\" true", name), world).values) << name;
    EXPECT_NE(switched, plain) << name;
    EXPECT_EQ(switched, Render(fmt::format("Option \"{}\" false", name), world, overrides).values) << name;
  }
}

uint64_t TrianglesOf(const std::string& settings, const RenderOptions& overrides,
                     const std::string& edge_length = "\"float edgelength\" 0.5") {
  MemoryFiles files({{"a.pbrt", settings + R"(
    WorldBegin Texture "d" "float" "constant" "float value" 0.1
    Shape "plymesh" "string filename" "a.ply" "texture displacement" "d" )" +
                                    edge_length},
                     {"a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                      "property float z\nproperty float u\nproperty float v\nelement face 1\n"
                      "property list uchar int vertex_indices\nend_header\n"
                      "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"}});
  const auto scene = Scene::Load(files, "a.pbrt", overrides, Scene::Depth::kCheck);
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene) return 0;
  for (const PrimitiveTotal& total : (*scene)->summary().primitives)
    if (total.name == "triangles") return total.count;
  return 0;
}

TEST(Options, TheCommandLineReplacesTheScaleOfDisplacementEdges) {
  RenderOptions fine;
  fine.displacement_edge_scale = 0.25f;
  const uint64_t coarse_count = TrianglesOf("", {}), fine_count = TrianglesOf("", fine);
  EXPECT_GT(fine_count, 4 * coarse_count);
  EXPECT_EQ(TrianglesOf("Option \"displacementedgescale\" 0.25", {}), fine_count);
  EXPECT_EQ(TrianglesOf("Option \"displacementedgescale\" 3", fine), fine_count);
  EXPECT_EQ(TrianglesOf("", fine, "\"float edgelength\" 0.125"),
            TrianglesOf("", {}, "\"float edgelength\" 0.03125"));
  fine.displacement_edge_scale = 0.0f;
  MemoryFiles files(std::map<std::string, std::string>{{"a.pbrt", "WorldBegin"}});
  EXPECT_EQ(Scene::Load(files, "a.pbrt", fine, Scene::Depth::kCheck).error().message,
            "--displacement-edge-scale: must be above 0");
}

// Light from a point that reaches the wall by way of a mirror alone, which no path can find.
TEST(Options, RegularizeShowsCausticsOfPointLights) {
  const std::string scene = R"(
    Material "diffuse" "rgb reflectance" [ 0.8 0.8 0.8 ]
    Shape "bilinearmesh" "point3 P" [ -4 -4 5  4 -4 5  -4 4 5  4 4 5 ]
    Material "diffuse" "rgb reflectance" [ 0 0 0 ]
    AttributeBegin Translate 0 3 2.5 Shape "disk" "float radius" 2.5 AttributeEnd
    Material "MATERIAL" "float roughness" 0
    Shape "bilinearmesh" "point3 P" [ -6 -6 -1  6 -6 -1  -6 6 -1  6 6 -1 ])";
  const auto mean = [&](const std::string& material, const std::string& parameters) {
    std::string text = scene;
    text.replace(text.find("MATERIAL"), 8, material);
    MemoryFiles files(
        {{"a.pbrt",
          "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
          "LookAt 0 0 0  0 -1 5  0 1 0 Camera \"perspective\" \"float fov\" 30\n"
          "Sampler \"independent\" \"integer pixelsamples\" 256 Integrator " +
              parameters + "\nWorldBegin LightSource \"point\" \"point3 from\" [ 0 3 2 ]\n" + text}});
    const Result<std::unique_ptr<Scene>> loaded = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kRender);
    EXPECT_TRUE(loaded) << loaded.error().message;
    if (!loaded) return 0.0;
    EXPECT_THAT((*loaded)->summary().warnings, testing::IsEmpty());
    const RadianceTile tile = *(*loaded)->Render({0, 0, 8, 8}, {}, {0, 256}, nullptr, nullptr);
    double sum = 0;
    for (size_t i = 0; i < 64; ++i) sum += tile.sums[i * 4 + 1] / (64 * 256);
    return sum;
  };
  for (const std::string integrator : {"\"path\"", "\"volpath\""}) {
    EXPECT_EQ(mean("conductor", integrator + " \"bool regularize\" false"), 0);
    const double metal = mean("conductor", integrator + " \"bool regularize\" true");
    EXPECT_GT(metal, 1e-4);
    EXPECT_LT(metal, 1);
    // The coat is one of the interfaces that become rough, whatever closed form the smooth one has.
    EXPECT_GT(mean("coateddiffuse", integrator + " \"bool regularize\" true"),
              1.001 * mean("coateddiffuse", integrator));
  }
}

TEST(Options, IntegratorsOfOtherPicturesAreReplacedWithAWarningThatSaysSo) {
  for (const std::string name : {"ambientocclusion", "function"}) {
    const Outcome outcome = Render("Integrator \"" + name + "\"", "");
    ASSERT_EQ(outcome.warnings.size(), 1u);
    EXPECT_EQ(outcome.warnings[0],
              "a.pbrt:4:1: integrator \"" + name +
                  "\" is not available: \"volpath\", which shows radiance and so another "
                  "picture, renders instead");
  }
  EXPECT_THAT(Render("Integrator \"bdpt\"", "").warnings[0],
              testing::HasSubstr("\"volpath\", which converges to the same picture, renders instead"));
}

TEST(Options, ExhaustiveLightSamplerIsReplacedWithAWarning) {
  const Outcome outcome = Render("Integrator \"path\" \"string lightsampler\" \"exhaustive\"", "");
  ASSERT_EQ(outcome.warnings.size(), 1u);
  EXPECT_THAT(outcome.warnings[0],
              testing::HasSubstr("light sampler \"exhaustive\" is not available: \"bvh\""));
}

}  // namespace
}  // namespace tessera::scene_options
