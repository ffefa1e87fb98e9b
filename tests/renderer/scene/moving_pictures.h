// Small pictures of scenes in which something moves, for tests.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"
#include "tests/renderer/scene/estimator_scenes.h"

namespace tessera {

constexpr int kMovingSize = 16;  // pixels

// The green channel of the picture of a scene that may refer to "sky.pfm", by row, from above.
inline std::vector<float> GreenOf(const std::string& text, const std::string& accelerator = "bvh",
                                  std::optional<double> time = {}) {
  MemoryFiles files({{"a.pbrt", text}, {"sky.pfm", BrightTexelMap()}});
  RenderOptions options;
  options.accelerator = accelerator;
  options.time = time;
  const auto scene = Scene::Load(files, "a.pbrt", options, Scene::Depth::kRender);
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene) return std::vector<float>(kMovingSize * kMovingSize);
  const FrameSpec& frame = (*scene)->frame();
  Merger merger(frame);
  for (int tile = 0; tile < frame.TileCount(); ++tile) {
    for (const SampleRange range : DyadicPartition(frame.samples_per_pixel))
      EXPECT_TRUE(merger.Add(tile, *(*scene)->Render(frame.TileBounds(tile), {}, range, nullptr)));
  }
  const auto picture = merger.Picture();
  const size_t channels = picture.values.size() / (kMovingSize * kMovingSize);
  std::vector<float> green;
  for (size_t i = 1; i < picture.values.size(); i += channels) green.push_back(picture.values[i]);
  return green;
}

// The start of a scene of that size, up to the world: x and y from -4 to 4 are seen along +z without
// perspective. `before` stands before the camera.
inline std::string MovingHead(const std::string& integrator, const std::string& before = "",
                              const std::string& shutter = "") {
  return "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 \"bool savefp16\" false\n"
         "PixelFilter \"box\" Sampler \"halton\" \"integer pixelsamples\" 1024\nIntegrator " +
         integrator + "\n" + before + "\nCamera \"orthographic\" \"float screenwindow\" [ -4 4 -4 4 ] " +
         shutter + "\nWorldBegin\n";
}

}  // namespace tessera
