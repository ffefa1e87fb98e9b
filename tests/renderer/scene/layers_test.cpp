// Layers of what is seen, against closed forms, and the table of all layers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "renderer/film/tile_limit.h"
#include "renderer/scene/layers.h"
#include "tests/renderer/scene/layer_scenes.h"

namespace tessera {
namespace {

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
    EXPECT_NEAR(Mean(*scene, tile, "normal.X"), 0, 0.02f);
    EXPECT_NEAR(Mean(*scene, tile, "normal.Y"), 0, 0.02f);
    EXPECT_NEAR(Mean(*scene, tile, "normal.Z"), -1, 0.001f);
  }
}

TEST(Layers, DepthIsTheLeastDistanceOfThePixel) {
  const auto scene = LoadWith(kBall, {"depth"});
  const float depth = Held(*scene, Rendered(*scene), "depth.Z");
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
  for (const char* channel : {"albedo.R", "normal.X", "normal.Y", "normal.Z", "depth.Z"}) {
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
  for (const Kind<Layer>& layer : Layers().kinds()) {
    const auto scene = LoadWith(kBall, {std::string(layer.name)});
    ASSERT_NE(scene, nullptr);
    const std::vector<Channel>& channels = scene->frame().channels;
    for (const Channel& channel : ChannelsOf(layer)) {
      EXPECT_NE(std::ranges::find(channels, channel), channels.end()) << channel.name;
    }
    if (layer.name == kLightGroupsLayer) continue;  // its channels are those of the scene's groups
    std::vector<Channel> written = ColorsAndWeight({"R", "G", "B"});
    for (const Channel& channel : ChannelsOf(layer)) AddChannel(written, channel);
    EXPECT_EQ(scene->frame().PictureChannels().size(),
              PictureChannels(written, kCryptomatteLevelsDefault).size())
        << layer.name;
  }
}

TEST(Layers, SetsStandForTheirLayersAndAllIsEverything) {
  const auto scene = LoadWith(kBall, {"all"});
  const ChannelLayout layout = scene->frame().Layout();
  for (const Kind<Layer>& layer : Layers().kinds()) {
    for (const Channel& channel : ChannelsOf(layer)) {
      const bool is_there = std::ranges::find(scene->frame().channels, channel.name, &Channel::name) !=
                            scene->frame().channels.end();
      EXPECT_EQ(is_there, layer.name != "motion") << channel.name << ": nothing moves";
    }
  }
  const auto denoise = LoadWith(kBall, {"denoise"});
  for (const char* channel : {"albedo.G", "normal.Z", "depth.Z", "variance.R", "halves.B",
                              "denoising_albedo.R", "denoising_normal.Y"}) {
    EXPECT_TRUE(denoise->frame().Layout().SlotOf(channel)) << channel;
  }
}

TEST(Layers, FilmNamesLayersToo) {
  std::string text = kBall;
  text.insert(text.find("\nPixelFilter"), " \"string layers\" [ \"albedo\" \"uv\" ]");
  const auto scene = LoadWith(text, {"depth"});
  for (const char* channel : {"albedo.R", "uv.V", "depth.Z"})
    EXPECT_TRUE(scene->frame().Layout().SlotOf(channel)) << channel;
  text.replace(text.find("\"uv\""), 4, "\"uw\"");
  MemoryFiles files({{"scene.pbrt", text}});
  const auto refused = Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kCheck);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("unknown layer \"uw\" (did you mean \"uv\"?)"));
}

// The plane z = 4 with its own axes: every value has a closed form at the place that a pixel sees.
constexpr const char* kWall = R"(
LookAt 1 2 0  1 2 1  0 1 0
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 90
Sampler "independent"
Option "disablepixeljitter" true
WorldBegin
LightSource "infinite"
Material "diffuse" "rgb reflectance" [ 0.6 0.4 0.2 ]
Shape "bilinearmesh" "point3 P" [ -9 -8 4  11 -8 4  -9 12 4  11 12 4 ]
)";

TEST(Layers, GeometryIsThatOfTheSurface) {
  const auto scene = LoadWith(kWall, {"position", "uv", "normal", "normal_geometric", "depth", "alpha"});
  const RadianceTile tile = *scene->Render({0, 0, 4, 4}, {}, {0, 1}, nullptr);
  // Pixel (2, 1): a quarter of the half field to the side, which is 90 degrees wide: x and y are 1 off.
  const float x = 1 + 1, y = 2 + 1;
  EXPECT_NEAR(Held(*scene, tile, "position.X"), x, 1e-4f);
  EXPECT_NEAR(Held(*scene, tile, "position.Y"), y, 1e-4f);
  EXPECT_NEAR(Held(*scene, tile, "position.Z"), 4, 1e-4f);
  EXPECT_NEAR(Held(*scene, tile, "depth.Z"), std::sqrt(18.0f), 1e-4f);
  EXPECT_NEAR(Held(*scene, tile, "uv.U"), (x + 9) / 20, 1e-4f);
  EXPECT_NEAR(Held(*scene, tile, "uv.V"), (y + 8) / 20, 1e-4f);
  EXPECT_NEAR(Mean(*scene, tile, "normal.Z"), -1, 1e-6f);
  EXPECT_NEAR(Mean(*scene, tile, "normal_geometric.Z"), -1, 1e-6f);
  EXPECT_EQ(Mean(*scene, tile, "A"), 1);
}

TEST(Layers, AlphaIsTheShareOfRaysThatStay) {
  std::string text = kBall;
  text.replace(text.find("Translate 1 2 17"), 16, "Translate 1 2 99");
  const auto sky = LoadWith(text.substr(0, text.find("Material")), {"alpha"});
  EXPECT_EQ(Mean(*sky, Rendered(*sky), "A"), 0);
  const auto ball = LoadWith(kBall, {"alpha"});
  EXPECT_EQ(Mean(*ball, Rendered(*ball), "A"), 1);
  // Fog that absorbs a half on the way of 2 units, for every integrator that follows media.
  for (const char* integrator : {"volpath", "simplevolpath", "mixture"}) {
    const std::string fog =
        std::string("Integrator \"") + integrator + "\"\n" + text.substr(0, text.find("Material")) +
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0.34657 "
        "0.34657 0.34657 ] \"rgb sigma_s\" [ 0 0 0 ]\nMediumInterface \"fog\" \"\"\nMaterial "
        "\"interface\"\nTranslate 1 2 7\nShape \"sphere\"\n";
    std::string narrow = fog;
    narrow.replace(narrow.find("fov\" 10"), 7, "fov\" 0.1");
    const auto scene = LoadWith(narrow, {"alpha"});
    EXPECT_NEAR(Mean(*scene, Rendered(*scene), "A"), 0.5f, 0.08f) << integrator;
  }
}

TEST(Layers, LayersLeaveTheBitsOfForcedDiffuseSurfacesAlone) {
  const std::string text = "Option \"forcediffuse\" true\n" + StageFor("path");
  const auto plain = LoadWith(text, {}), layered = LoadWith(text, {"all"});
  const RadianceTile plain_tile = Rendered(*plain), layered_tile = Rendered(*layered);
  for (const char* channel : {"R", "G", "B", "W"}) {
    EXPECT_EQ(Held(*plain, plain_tile, channel), Held(*layered, layered_tile, channel)) << channel;
  }
}

// Whether a farm renders them or one process: adaptive frames depend on their tiles.
TEST(Layers, TilesAreAsLargeAsTheirLayersAllow) {
  const auto load = [](const std::set<std::string>& layers) {
    MemoryFiles files({{"scene.pbrt", std::string(kBall)}});
    RenderOptions options;
    options.aovs = layers;
    options.tile_size = kTileSizeMax;
    return *Scene::Load(files, "scene.pbrt", options, Scene::Depth::kCheck);
  };
  const auto all = load({"all"});
  const FrameSpec& frame = all->frame();
  const auto bytes_of = [&](int size) {
    return static_cast<int64_t>(frame.Layout().shape().floats_max() * sizeof(float)) * size * size;
  };
  EXPECT_LT(frame.tile_size, kTileSizeMax);
  EXPECT_LE(bytes_of(frame.tile_size), kTileBytesMax);
  EXPECT_GT(bytes_of(frame.tile_size + 1), kTileBytesMax);
  EXPECT_THAT(all->summary().warnings, testing::Contains(testing::HasSubstr("instead of 256 pixels")));
  EXPECT_EQ(load({"albedo"})->frame().tile_size, kTileSizeMax);
}

TEST(Layers, WhatCannotBeFilledIsAWarning) {
  const auto warnings = [](const std::string& text, const std::set<std::string>& layers) {
    const auto scene = LoadWith(text, layers);
    std::string all;
    for (const std::string& warning : scene->summary().warnings) all += warning + "\n";
    return all;
  };
  EXPECT_THAT(warnings(kBall, {"motion"}), testing::HasSubstr("layer \"motion\" is zero"));
  EXPECT_THAT(warnings(StageFor("mixture"), {"shadow"}), testing::HasSubstr("layer \"shadow\" is black"));
  EXPECT_THAT(warnings(StageFor("path"), {"shadow"}), testing::Not(testing::HasSubstr("shadow")));
}

}  // namespace
}  // namespace tessera
