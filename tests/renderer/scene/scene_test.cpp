#include "renderer/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "renderer/film/merger.h"
#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

// Sampler, film and camera at the centre of the world, looking along +z.
constexpr const char* kHead = R"(
Film "rgb" "integer xresolution" 16 "integer yresolution" 16 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 60
)";

std::unique_ptr<Scene> LoadText(const std::string& text, const RenderOptions& options = {}) {
  MemoryFiles files({{"scene.pbrt", text}});
  Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
  EXPECT_TRUE(scene.has_value()) << scene.error().message;
  return scene ? std::move(*scene) : nullptr;
}

std::string LoadError(const std::string& text, const RenderOptions& options = {}) {
  MemoryFiles files({{"scene.pbrt", text}});
  Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kCheck);
  return scene ? "" : scene.error().message;
}

FramePicture RenderWhole(const Scene& scene) {
  Merger merger(scene.frame());
  for (int tile = 0; tile < scene.frame().TileCount(); ++tile) {
    for (SampleRange range : DyadicPartition(scene.frame().samples_per_pixel)) {
      std::optional<RadianceTile> result = scene.Render(scene.frame().TileBounds(tile), {}, range, nullptr);
      EXPECT_TRUE(merger.Add(tile, std::move(*result)));
    }
  }
  EXPECT_TRUE(merger.Complete());
  return merger.Picture();
}

struct Mean {
  double rgb[3] = {0, 0, 0};
};

Mean MeanOf(const FramePicture& picture) {
  Mean mean;
  for (size_t i = 0; i < picture.values.size(); ++i) mean.rgb[i % 3] += picture.values[i];
  for (double& c : mean.rgb) c /= static_cast<double>(picture.values.size()) / 3;
  return mean;
}

void ExpectMean(const FramePicture& picture, double expected, double tolerance, const std::string& what) {
  const Mean mean = MeanOf(picture);
  for (double c : mean.rgb) EXPECT_NEAR(c, expected, tolerance) << what;
}

// Inside a sphere that emits Le and reflects rho everywhere, radiance is Le / (1 - rho) everywhere (geometric
// series of bounces). Light and BSDF sampling must each bring their share, whatever the sampler.
TEST(Scene, RadianceInsideAGlowingDiffuseSphereIsTheGeometricSeries) {
  for (const char* sampler :
       {"independent", "stratified", "sobol", "paddedsobol", "zsobol", "halton", "pmj02bn"}) {
    const std::string samples = std::string(sampler) == "stratified"
                                    ? "\"integer xsamples\" 8 \"integer ysamples\" 8"
                                    : "\"integer pixelsamples\" 64";
    const auto scene = LoadText(std::string(kHead) + "Sampler \"" + sampler + "\" " + samples + R"(
Integrator "path" "integer maxdepth" 100
WorldBegin
ReverseOrientation
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
AreaLightSource "diffuse" "rgb L" [ 0.5 0.5 0.5 ]
Shape "sphere"
)");
    ASSERT_TRUE(scene);
    ExpectMean(RenderWhole(*scene), 1, 0.01, sampler);
  }
}

// The same with a point light of intensity pi at the centre of a unit sphere: the first reflection is rho, so
// the radiance is rho / (1 - rho).
TEST(Scene, RadianceInsideADiffuseSphereLitByAPointIsTheGeometricSeries) {
  const auto scene = LoadText(std::string(kHead) + R"(
Sampler "sobol" "integer pixelsamples" 256
Integrator "path" "integer maxdepth" 100
WorldBegin
LightSource "point" "rgb I" [ 3.14159265 3.14159265 3.14159265 ]
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "sphere"
)");
  ASSERT_TRUE(scene);
  ExpectMean(RenderWhole(*scene), 1, 0.01, "point light");
}

// In a furnace of uniform radiance 1 no surface that absorbs nothing can be seen.
TEST(Scene, SurfacesThatAbsorbNothingVanishInAWhiteFurnace) {
  for (const char* material :
       {R"("diffuse" "rgb reflectance" [ 1 1 1 ])", R"("dielectric" "float eta" 1.5)",
        R"("thindielectric" "float eta" 1.5)", R"("conductor" "rgb reflectance" [ 1 1 1 ])"}) {
    const auto scene = LoadText(std::string(kHead) + R"(
Sampler "sobol" "integer pixelsamples" 256
Integrator "path" "integer maxdepth" 200
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material )" + material + R"(
AttributeBegin
Translate 0 0 4
Shape "sphere" "float radius" 1.5
AttributeEnd
)");
    ASSERT_TRUE(scene);
    ExpectMean(RenderWhole(*scene), 1, 0.012, material);
  }
}

// A distant light of radiance-normalised irradiance E on a facing Lambertian plane gives rho E / pi.
TEST(Scene, DistantLightOnADiffusePlaneHasTheClosedForm) {
  const auto scene = LoadText(std::string(kHead) + R"(
Sampler "sobol" "integer pixelsamples" 16
Integrator "path" "integer maxdepth" 1
WorldBegin
LightSource "distant" "point3 from" [ 0 0 -1 ] "point3 to" [ 0 0 1 ] "rgb L" [ 2 2 2 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.6 ]
Shape "disk" "float height" 5 "float radius" 100
)");
  ASSERT_TRUE(scene);
  ExpectMean(RenderWhole(*scene), 0.6 * 2 / 3.14159265, 0.004, "distant");
}

constexpr const char* kRoom = R"(
Sampler "sobol" "integer pixelsamples" 24
Integrator "path" "integer maxdepth" 6
WorldBegin
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 8 7 ]
Translate 0 3 3
Rotate 90 1 0 0
Shape "disk" "float radius" 0.7
AttributeEnd
Texture "checks" "spectrum" "checkerboard" "float uscale" 8 "float vscale" 8 "rgb tex1" [ 0.9 0.2 0.1 ] "rgb tex2" 0.1
Material "coateddiffuse" "texture reflectance" "checks" "float roughness" 0.05
Shape "trianglemesh" "point3 P" [ -5 -1 0  5 -1 0  5 -1 9  -5 -1 9 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
  "integer indices" [ 0 1 2 0 2 3 ]
AttributeBegin
Translate -0.7 0 4
Material "dielectric" "spectrum eta" "glass-BK7"
Shape "sphere" "float radius" 0.9
AttributeEnd
AttributeBegin
Translate 1.2 0 4.5
Material "conductor" "float roughness" 0.1
Shape "sphere" "float radius" 0.9
AttributeEnd
)";

std::string Room() {
  std::string text = std::string(kHead) + kRoom;
  const size_t place = text.find("\"rgb tex2\" 0.1");
  return text.replace(place, 14, "\"rgb tex2\" [ 0.1 0.1 0.1 ]");
}

TEST(Scene, AUnitIsAPureFunctionOfSceneAndUnit) {
  const auto first = LoadText(Room()), second = LoadText(Room());
  ASSERT_TRUE(first && second);
  const PixelBounds bounds{3, 2, 13, 15};
  const RadianceTile expected = *first->Render(bounds, {}, {8, 8}, nullptr);
  (void)second->Render({0, 0, 16, 16}, {}, {0, 4}, nullptr);
  EXPECT_EQ(*second->Render(bounds, {}, {8, 8}, nullptr), expected);
  std::vector<RadianceTile> tiles(4);
  std::vector<std::thread> threads;
  for (RadianceTile& tile : tiles) {
    threads.emplace_back([&tile, &first, bounds] { tile = *first->Render(bounds, {}, {8, 8}, nullptr); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const RadianceTile& tile : tiles) EXPECT_EQ(tile, expected);
}

TEST(Scene, HalvesOfARangeAddUpToTheRange) {
  const auto scene = LoadText(Room());
  ASSERT_TRUE(scene);
  const PixelBounds bounds{0, 0, 16, 16};
  const RadianceTile whole = *scene->Render(bounds, {}, {0, 16}, nullptr);
  const RadianceTile left = *scene->Render(bounds, {}, {0, 8}, nullptr),
                     right = *scene->Render(bounds, {}, {8, 8}, nullptr);
  for (size_t i = 0; i < whole.sums.size(); ++i) ASSERT_EQ(left.sums[i] + right.sums[i], whole.sums[i]);
}

TEST(Scene, TileSizeAndCropDoNotChangeAPixel) {
  RenderOptions small;
  small.tile_size = 5;
  RenderOptions crop;
  crop.crop = {0.25f, 0.75f, 0.5f, 1};
  const auto whole = LoadText(Room()), tiles = LoadText(Room(), small), cropped = LoadText(Room(), crop);
  ASSERT_TRUE(whole && tiles && cropped);
  const FramePicture expected = RenderWhole(*whole);
  EXPECT_EQ(RenderWhole(*tiles).values, expected.values);
  const FramePicture part = RenderWhole(*cropped);
  ASSERT_EQ(part.bounds, (PixelBounds{4, 8, 12, 16}));
  for (int y = 8; y < 16; ++y) {
    for (int x = 4; x < 12; ++x) {
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(part.values[((y - 8) * 8 + x - 4) * 3 + c], expected.values[(y * 16 + x) * 3 + c]);
      }
    }
  }
}

Result<FrameSpec> FrameOf(const std::string& film, const RenderOptions& options) {
  MemoryFiles files(std::map<std::string, std::string>{
      {"scene.pbrt", "Film \"rgb\" " + film + " Sampler \"halton\"\nWorldBegin"}});
  const auto scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kCheck);
  if (!scene) return scene.error();
  return (*scene)->frame();
}

TEST(Scene, AQuickPictureHasOneSampleInAQuarterOfTheWidthAndHeight) {
  RenderOptions quick;
  quick.quick = true;
  const std::string film = "\"integer xresolution\" 402 \"integer yresolution\" 3 ";
  const FrameSpec draft = *FrameOf(film, quick);
  EXPECT_EQ(draft.width, 100);
  EXPECT_EQ(draft.height, 1);
  EXPECT_EQ(draft.crop, (PixelBounds{0, 0, 100, 1}));
  EXPECT_EQ(draft.samples_per_pixel, 1u);
  const FrameSpec part = *FrameOf(film + "\"integer pixelbounds\" [ 9 200 2 3 ]", quick);
  EXPECT_EQ(part.crop, (PixelBounds{2, 0, 50, 1}));
  EXPECT_EQ(FrameOf(film + "\"integer pixelbounds\" [ 401 402 0 1 ]", quick)->crop,
            (PixelBounds{99, 0, 100, 1}));
  quick.samples_per_pixel = 8;
  quick.width = quick.height = 40;
  const FrameSpec given = *FrameOf(film, quick);
  EXPECT_EQ(given.width, 40);
  EXPECT_EQ(given.samples_per_pixel, 8u);
}

TEST(Scene, PixelBoundsOfTheCommandLineReplaceTheCropOfTheScene) {
  const std::string film =
      "\"integer xresolution\" 40 \"integer yresolution\" 30 \"float cropwindow\" [0 .5 0 .5]";
  RenderOptions options;
  options.pixel_bounds = {3, 9, 5, 100};
  EXPECT_EQ(FrameOf(film, options)->crop, (PixelBounds{3, 5, 9, 30}));
  options.pixel_bounds = {40, 50, 0, 10};
  EXPECT_EQ(FrameOf(film, options).error().message, "the crop holds no pixel");
  options.crop = {0, 1, 0, 1};
  EXPECT_EQ(FrameOf(film, options).error().message,
            "--crop and --pixelbounds exclude each other, expected one of them");
}

TEST(Scene, SeedChangesTheNoise) {
  RenderOptions seed;
  seed.seed = 5;
  const auto a = LoadText(Room()), b = LoadText(Room(), seed);
  ASSERT_TRUE(a && b);
  EXPECT_NE(RenderWhole(*a).values, RenderWhole(*b).values);
}

TEST(Scene, StopEndsARenderWithoutAResult) {
  const auto scene = LoadText(Room());
  ASSERT_TRUE(scene);
  const std::atomic<bool> stop{true};
  EXPECT_FALSE(scene->Render({0, 0, 16, 16}, {}, {0, 16}, &stop));
}

// Each pixel as in a rendering of all, its samples counted; the others stay zeros.
TEST(Scene, RendersThePixelsAskedFor) {
  RenderOptions options;
  options.noise_threshold = 0.1;
  const auto scene = LoadText(Room(), options);
  ASSERT_TRUE(scene);
  const PixelBounds bounds = scene->frame().TileBounds(0);
  const size_t channels = scene->frame().Layout().shape().stride();
  std::vector<bool> chosen(static_cast<size_t>(bounds.area()));
  for (size_t i = 0; i < chosen.size(); i += 3) chosen[i] = true;
  const auto whole = scene->Render(bounds, {}, {8, 4}, nullptr);
  const auto part = scene->Render(bounds, PixelMask::Of(chosen), {8, 4}, nullptr);
  ASSERT_TRUE(whole && part);
  EXPECT_TRUE(HasExactly(scene->frame().Layout(), {}, *whole));
  EXPECT_TRUE(HasExactly(scene->frame().Layout(), PixelMask::Of(chosen), *part));
  for (size_t i = 0; i < part->sums.size(); ++i)
    ASSERT_EQ(part->sums[i], chosen[i / channels] ? whole->sums[i] : 0.0f) << i;
}

TEST(Scene, AFrameToBeDenoisedHasTheLayersForIt) {
  RenderOptions options;
  const auto plain = LoadText(Room());
  options.denoise = true;
  const auto denoised = LoadText(Room(), options);
  ASSERT_TRUE(plain && denoised);
  EXPECT_EQ(plain->frame().denoiser, Denoiser::kNone);
  EXPECT_EQ(denoised->frame().denoiser, Denoiser::kRegression);
  options.denoiser = Denoiser::kOidn;
  EXPECT_EQ(LoadText(Room(), options)->frame().denoiser, Denoiser::kOidn);
  options.denoiser.reset();
  options.denoise = false;
  options.aovs = {"denoise"};
  EXPECT_EQ(denoised->frame().channels, LoadText(Room(), options)->frame().channels);
}

TEST(Scene, RenderOptionsSurviveTheirCodec) {
  RenderOptions options;
  options.samples_per_pixel = 200;
  options.width = 64;
  options.height = 48;
  options.crop = {0, 0.3333333f, 0.1f, 1};
  options.seed = 0xffffffffffffffffu;
  options.integrator = "path";
  options.max_depth = 3;
  options.tile_size = 17;
  options.exr_type = ExrType::kFloat;
  options.noise_threshold = 0.1;
  options.aovs = {"samples"};
  options.denoise = true;
  options.denoiser = Denoiser::kOidn;
  options.cryptomatte_levels = 6;
  options.pixel_bounds = {1, 30, 2, 40};
  options.disable_pixel_jitter = options.disable_wavelength_jitter = true;
  options.disable_texture_filtering = options.force_diffuse = options.disable_image_textures = true;
  options.displacement_edge_scale = 0.25f;
  options.quick = true;
  const Result<RenderOptions> decoded = DecodeRenderOptions(EncodeRenderOptions(options));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(*decoded, options);
  EXPECT_EQ(*DecodeRenderOptions(EncodeRenderOptions({})), RenderOptions{});
  for (const char* bad :
       {"spp=x\n", "spp\n", "sppp=4\n", "crop=0,1,0\n", "crop=0,1,0,1,2\n", "spp=-4\n", "exr-type=double\n",
        "aov=\n", "aov=sample\n", "noise-threshold=x\n", "quick=1\n", "quick=\n", "force-diffuse=yes\n",
        "pixelbounds=0,1,0\n", "pixelbounds=0,1.5,0,1\n", "displacement-edge-scale=nan\n",
        "cryptomatte-levels=-1\n", "cryptomatte-levels=4294967296\n", "cryptomatte-levels=six\n"}) {
    EXPECT_FALSE(DecodeRenderOptions(bad)) << bad;
  }
}

TEST(Scene, WhatIsWrongIsNamedWithItsPlace) {
  const std::string head = kHead;
  EXPECT_EQ(LoadError("Film \"rgb\" \"integer xresolution\" -4\nWorldBegin\n"),
            "scene.pbrt:1:12: xresolution must lie between 1 and 65536, not -4");
  EXPECT_EQ(LoadError("Film \"rgba\"\nWorldBegin\n"),
            "scene.pbrt:1:1: unknown film \"rgba\" (did you mean \"rgb\"?)");
  EXPECT_EQ(LoadError("Sampler \"sobel\"\nWorldBegin\n"),
            "scene.pbrt:1:1: unknown sampler \"sobel\" (did you mean \"sobol\"?)");
  EXPECT_EQ(LoadError("Option \"wavefront\" true\n" + head + "WorldBegin\nShape \"sphere\"\n"),
            "scene.pbrt: the scene asks for the wavefront renderer but has no light source");
  RenderOptions options;
  options.samples_per_pixel = 0;
  EXPECT_EQ(LoadError(Room(), options), "--spp: must lie between 1 and 1048576");
  options = {};
  options.accelerator = "quadtree";
  EXPECT_EQ(LoadError(Room(), options), "--accelerator: unknown accelerator \"quadtree\"");
}

TEST(Scene, ASceneWithoutLightOrShapesIsBlackWithAWarning) {
  const auto scene = LoadText(std::string(kHead) + "WorldBegin\n");
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->summary().warnings.size(), 1u);
  ExpectMean(RenderWhole(*scene), 0, 0, "no light");
}

TEST(Scene, IntegratorsWeDoNotHaveAreReplacedWithAWarning) {
  const auto scene = LoadText(std::string(kHead) + R"(
Integrator "mlt" "integer chains" 7
WorldBegin
LightSource "point"
Shape "sphere"
)");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->summary().integrator, "volpath");
  ASSERT_EQ(scene->summary().warnings.size(), 1u);
  EXPECT_EQ(scene->summary().warnings[0].substr(0, 34), "scene.pbrt:6:1: integrator \"mlt\" i");
}

}  // namespace
}  // namespace tessera
