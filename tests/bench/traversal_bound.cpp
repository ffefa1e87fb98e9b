// What share of a render is traversal: records the rays of a render and traces them again with nothing but
// rtcIntersect1 and rtcOccluded1 in between, in the same order, on one thread. That time is what remains if
// everything else were free; the share is it divided by the time of the render. Usage:
//   traversal_bound [--spp N] [--width W --height H] SCENE ...
// Each unit is rendered and its rays are traced right before both are timed, so both find the same caches.
// Returns 1 if a ray that is traced again finds something else.
#include <fmt/format.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "renderer/description/file_source.h"
#include "renderer/scene/scene.h"
#include "tests/bench/ray_recorder.h"

namespace tessera {
namespace {

// Of a unit: its recorded rays fit the cache that all processors share.
constexpr uint32_t kUnitSamplesMax = 4;

struct BoundOptions {
  uint32_t spp = 8;
  int width = 0, height = 0;  // 0: those of the scene
  std::string integrator;
  std::vector<std::string> scenes;
};

struct BoundFigures {
  double render_s = 0, replay_s = 0;
  uint64_t closest = 0, occlusion = 0, different = 0;
};

double ThreadSeconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void MeasureUnit(const Scene& scene, PixelBounds bounds, SampleRange range, RayRecorder& recorder,
                 BoundFigures* figures) {
  recorder.Clear();
  scene.Render(bounds, {}, range, nullptr);
  recorder.Pause(true);
  const double start = ThreadSeconds();
  figures->different += Replay(recorder);
  const double replayed = ThreadSeconds();
  scene.Render(bounds, {}, range, nullptr);
  figures->render_s += ThreadSeconds() - replayed;
  figures->replay_s += replayed - start;
  recorder.Pause(false);
  figures->occlusion += recorder.occlusion_count();
  figures->closest += recorder.calls().size() - recorder.occlusion_count();
}

Result<BoundFigures> Measure(const std::string& path, const BoundOptions& options) {
  const size_t slash = path.rfind('/');
  DiskFileSource files(slash == std::string::npos ? "." : path.substr(0, slash));
  RenderOptions render;
  render.samples_per_pixel = options.spp;
  render.accelerator = "embree";
  render.integrator = options.integrator;
  if (options.width > 0) {
    render.width = options.width;
    render.height = options.height;
  }
  const auto loaded = Scene::Load(files, slash == std::string::npos ? path : path.substr(slash + 1), render,
                                  Scene::Depth::kRender);
  if (!loaded) return loaded.error();
  const FrameSpec& frame = (*loaded)->frame();
  BoundFigures figures;
  RayRecorder recorder;
  for (int tile = 0; tile < frame.TileCount(); ++tile) {
    for (const SampleRange whole : DyadicPartition(frame.samples_per_pixel)) {
      const uint32_t size = std::min(whole.size, kUnitSamplesMax);
      for (uint32_t begin = whole.begin; begin < whole.end(); begin += size)
        MeasureUnit(**loaded, frame.TileBounds(tile), {begin, size}, recorder, &figures);
    }
  }
  return figures;
}

int Run(const BoundOptions& options) {
  fmt::print(
      "| scene | M closest hits | M occlusions | render CPU s | traversal CPU s | traversal share |\n"
      "|---|---|---|---|---|---|\n");
  uint64_t different = 0;
  for (const std::string& scene : options.scenes) {
    const auto figures = Measure(scene, options);
    if (!figures) {
      fmt::print(stderr, "{}\n", figures.error().message);
      return static_cast<int>(figures.error().kind);
    }
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} % |\n", scene,
               static_cast<double>(figures->closest) / 1e6, static_cast<double>(figures->occlusion) / 1e6,
               figures->render_s, figures->replay_s, 100 * figures->replay_s / figures->render_s);
    std::fflush(stdout);
    if (figures->closest == 0) {
      fmt::print(stderr, "{}: no ray was recorded\n", scene);
      return 1;
    }
    different += figures->different;
  }
  if (different > 0)
    fmt::print(stderr, "{} rays find something else when they are traced again\n", different);
  return different > 0 ? 1 : 0;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::BoundOptions options;
  CLI::App app("Measure the share of traversal in the time of a render");
  app.add_option("--spp", options.spp, "Samples per pixel")->check(CLI::Range(1, 1 << 16));
  auto* width = app.add_option("--width", options.width, "Width of the picture; requires --height");
  auto* height = app.add_option("--height", options.height, "Height of the picture; requires --width");
  width->needs(height);
  height->needs(width);
  app.add_option("--integrator", options.integrator, "See tessera render --integrator");
  app.add_option("scenes", options.scenes, "SCENE ...")->required();
  CLI11_PARSE(app, argc, argv);
  return tessera::Run(options);
}
