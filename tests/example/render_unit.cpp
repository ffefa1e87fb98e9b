// An example to read: what a farm does with one frame, in one process and on one thread.
//
//   render_unit SCENE.pbrt PICTURE.exr
//
// A coordinator cuts a frame into tiles and the samples of each pixel into ranges. A tile and a range are a
// work unit, which a worker renders into sums of radiance. The coordinator adds the sums of all units and
// writes the picture. Here every tile is rendered in two units.
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "renderer/film/merger.h"
#include "renderer/film/picture_file.h"
#include "renderer/scene/scene.h"
#include "renderer/util/file.h"
#include "renderer/util/processor.h"

namespace tessera {
namespace {

constexpr uint32_t kSamplesPerPixel = 16;

// Reads the scene and everything that it refers to, and builds its acceleration structure. After that a scene
// does not change, so any number of threads may render from it. All files are read through a FileSource: here
// from the folder of the scene, on a worker from its cache of verified files.
Result<std::unique_ptr<Scene>> LoadScene(const std::filesystem::path& path) {
  DiskFileSource files(path.parent_path().string());
  RenderOptions options;
  options.samples_per_pixel = kSamplesPerPixel;
  return Scene::Load(files, path.filename().string(), options, Scene::Depth::kRender);
}

// Renders samples `range` of every pixel of a tile. The result depends on the scene, the tile and the range
// only: sample s of pixel p draws its random numbers from (seed, p, s). It does not matter who renders a
// unit, when, or how often.
RadianceTile RenderUnit(const Scene& scene, int tile, SampleRange range) {
  const PixelMask all_pixels;
  const std::atomic<bool>* never_stop = nullptr;
  auto sums = scene.Render(scene.frame().TileBounds(tile), all_pixels, range, never_stop);
  return std::move(sums).value();
}

Result<FramePicture> RenderFrame(const Scene& scene) {
  Merger merger(scene.frame());
  // The samples of a pixel are the leaves of a binary tree, and a range is a node of it: the sums of both
  // halves add up to exactly the bits of the whole, in whatever order they arrive. So the second half may
  // come first.
  const SampleRange halves[] = {{kSamplesPerPixel / 2, kSamplesPerPixel / 2}, {0, kSamplesPerPixel / 2}};
  for (const SampleRange range : halves) {
    for (int tile = 0; tile < scene.frame().TileCount(); ++tile) {
      const auto added = merger.Add(tile, RenderUnit(scene, tile, range));
      if (!added) return added.error();
    }
  }
  if (!merger.Complete()) return Failed("some samples are missing");
  // A pixel is the sum of its samples divided by the sum of their filter weights.
  return merger.Picture();
}

Result<void> Run(const std::string& scene_path, const std::string& picture_path) {
  const auto scene = LoadScene(scene_path);
  if (!scene) return scene.error();
  const auto picture = RenderFrame(**scene);
  if (!picture) return picture.error();
  const auto exr = EncodeExr((*scene)->frame(), *picture);
  if (!exr) return exr.error();
  return WriteFileAtomically(picture_path, *exr);
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  // The code is compiled for AVX2, on which all machines compute the same bits.
  tessera::RequireProcessor();
  if (argc != 3) {
    fmt::print(stderr, "Usage: render_unit SCENE.pbrt PICTURE.exr\n");
    return 2;
  }
  const auto done = tessera::Run(argv[1], argv[2]);
  if (done) return 0;
  fmt::print(stderr, "render_unit: {}\n", done.error().message);
  return static_cast<int>(done.error().kind);
}
