// A world that rays can be traced in, from scene text, for tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "renderer/accelerator/accelerator.h"
#include "renderer/pbrt/parser.h"
#include "renderer/scene/world_builder.h"
#include "tests/renderer/memory_files.h"
#include "tests/renderer/scene/estimator_scenes.h"

namespace tessera {

// The world of a scene that starts with SceneHead and may refer to "sky.pfm".
inline std::unique_ptr<World> BuiltWorld(const std::string& text, bool with_media = false) {
  MemoryFiles files({{"scene.pbrt", SceneHead("\"path\"", 3) + text}, {"sky.pfm", BrightTexelMap()}});
  const Result<SceneDescription> scene = ParseScene(files, "scene.pbrt");
  EXPECT_TRUE(scene) << scene.error().message;
  ImageCache images(files);
  auto world = std::make_unique<World>();
  Diagnostics diagnostics;
  world->camera = *Camera::Read(scene->camera, scene->camera_from_world, {8, 8}, images, diagnostics);
  const auto built =
      BuildWorld({*scene, files, images, LightSamplerKind::kTree, with_media}, world.get(), diagnostics);
  EXPECT_TRUE(built) << built.error().message;
  world->accelerator = *MakeAccelerator(*Accelerators().Find("embree"), world->geometry, world->textures);
  return world;
}

}  // namespace tessera
