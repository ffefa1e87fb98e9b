// The layers of a rendered tile, against closed forms.
#include "renderer/scene/layers.h"

#include <gtest/gtest.h>

#include <memory>

#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

constexpr uint32_t kLayerSamples = 256;

// Looks along +z from (1, 2, 3) at a grey ball that covers the view, 4 units away.
constexpr const char* kBall = R"(
LookAt 1 2 3  1 2 4  0 1 0
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 10
Sampler "independent"
WorldBegin
LightSource "infinite"
Material "diffuse" "rgb reflectance" [ 0.6 0.4 0.2 ]
Translate 1 2 17
Shape "sphere" "float radius" 10
)";

std::unique_ptr<Scene> LoadWith(const std::string& text, const std::set<std::string>& layers) {
  MemoryFiles files({{"scene.pbrt", text}});
  RenderOptions options;
  options.aovs = layers;
  options.samples_per_pixel = kLayerSamples;
  Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : nullptr;
}

RadianceTile Rendered(const Scene& scene) {
  return *scene.Render({0, 0, 4, 4}, {}, {0, kLayerSamples}, nullptr);
}

// A channel of pixel (2, 1) as the tile holds it, next to the middle of the picture.
float Held(const Scene& scene, const RadianceTile& tile, const std::string& channel) {
  const ChannelLayout layout = scene.frame().Layout();
  return tile.sums[(1 * 4 + 2) * layout.shape().stride() + *layout.SlotOf(channel)];
}
float Mean(const Scene& scene, const RadianceTile& tile, const std::string& channel) {
  return Held(scene, tile, channel) / Held(scene, tile, "W");
}

TEST(Layers, AlbedoIsTheReflectance) {
  const auto scene = LoadWith(kBall, {"albedo"});
  const RadianceTile tile = Rendered(*scene);
  // The noise is that of the wavelengths.
  EXPECT_NEAR(Mean(*scene, tile, "albedo.R"), 0.6f, 0.03f);
  EXPECT_NEAR(Mean(*scene, tile, "albedo.G"), 0.4f, 0.02f);
  EXPECT_NEAR(Mean(*scene, tile, "albedo.B"), 0.2f, 0.02f);
}

TEST(Layers, NormalFacesTheCameraInWorldSpace) {
  for (const char* orientation : {"", "ReverseOrientation\n"}) {
    std::string text = kBall;
    text.insert(text.find("Shape"), orientation);
    const auto scene = LoadWith(text, {"normal"});
    const RadianceTile tile = Rendered(*scene);
    EXPECT_NEAR(Mean(*scene, tile, "N.X"), 0, 0.02f);
    EXPECT_NEAR(Mean(*scene, tile, "N.Y"), 0, 0.02f);
    EXPECT_NEAR(Mean(*scene, tile, "N.Z"), -1, 0.001f);
  }
}

TEST(Layers, DepthIsTheLeastDistanceOfThePixel) {
  const auto scene = LoadWith(kBall, {"depth"});
  const float depth = Held(*scene, Rendered(*scene), "Z");
  EXPECT_GE(depth, 4);
  EXPECT_LT(depth, 4.01f);
}

TEST(Layers, PixelThatSeesNothingHasNone) {
  std::string text = kBall;
  text.replace(text.find("Translate 1 2 17"), 16, "Translate 1 2 99");
  text.replace(text.find("radius\" 10"), 10, "radius\" 1 ");
  const auto scene = LoadWith(text, {"albedo", "depth", "normal"});
  const RadianceTile tile = *scene->Render({0, 0, 4, 4}, {}, {0, 1}, nullptr);
  const ChannelLayout layout = scene->frame().Layout();
  for (const char* channel : {"albedo.R", "N.X", "N.Y", "N.Z", "Z"}) {
    EXPECT_EQ(tile.sums[*layout.SlotOf(channel)], 0) << channel;
  }
  EXPECT_GT(tile.sums[*layout.SlotOf("R")], 0) << "the sky";
}

TEST(Layers, ColoursHaveTheSameBitsWithAndWithoutLayers) {
  const auto plain = LoadWith(kBall, {});
  const auto layered = LoadWith(kBall, {"albedo", "depth", "normal"});
  const RadianceTile plain_tile = Rendered(*plain), layered_tile = Rendered(*layered);
  for (const char* channel : {"R", "G", "B", "W"}) {
    EXPECT_EQ(Held(*plain, plain_tile, channel), Held(*layered, layered_tile, channel)) << channel;
  }
}

TEST(Layers, EveryLayerMakesAFrameThatPassesItsChecks) {
  for (const std::string_view name : Layers().Names()) {
    const auto scene = LoadWith(kBall, {std::string(name)});
    ASSERT_NE(scene, nullptr);
    const size_t expected = 4 + Layers().Find(name)->reader.channels().size();
    EXPECT_EQ(scene->frame().channels.size(), expected) << name;
  }
}

}  // namespace
}  // namespace tessera
