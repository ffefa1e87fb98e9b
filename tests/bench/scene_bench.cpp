// Renders a list of scenes on this machine and prints, for each, load seconds, camera paths and rays per CPU
// second, relMSE against a reference and relMSE x CPU seconds: the figure that counts, since it does not
// depend on the number of samples. Usage:
//   scene_bench [--spp N] [--seeds K] [--threads T] [--csv FILE] SCENE=REFERENCE.exr ...
// The picture has the size of its reference. relMSE is the mean of (a - b)^2 / (b^2 + 0.01) over R, G and B,
// the worst 0.1 % of values left out, divided by 1 + spp / reference spp for the reference's own noise
// (--reference-spp, default 512).
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>

#include "film/merger.h"
#include "film/picture_file.h"
#include "scene/scene.h"
#include "util/file.h"

namespace tessera {
namespace {

struct BenchOptions {
  uint32_t spp = 64;
  int seeds = 1;
  int threads = 2;
  double reference_spp = 512;
  std::string csv, accelerator;
  std::vector<std::string> scenes;
};

struct Row {
  std::string name;
  double load_seconds = 0, render_wall = 0, render_cpu = 0;
  double relmse = 0;
  uint64_t paths = 0;
  RenderStatistics rays;
};

double CpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Every pixel of the frame, on `threads` threads.
FramePicture RenderWhole(const Scene& scene, int threads, RenderStatistics* rays) {
  const FrameSpec& frame = scene.frame();
  Merger merger(frame);
  std::atomic<int> next{0};
  std::mutex mutex;
  std::vector<std::thread> pool;
  for (int t = 0; t < threads; ++t) {
    pool.emplace_back([&] {
      RenderStatistics own;
      for (int tile = next++; tile < frame.TileCount(); tile = next++) {
        for (SampleRange range : DyadicPartition(frame.samples_per_pixel)) {
          std::optional<RadianceTile> result = scene.Render(frame.TileBounds(tile), range, nullptr, &own);
          const std::lock_guard lock(mutex);
          (void)merger.Add(tile, std::move(*result));
        }
      }
      const std::lock_guard lock(mutex);
      rays->camera_rays += own.camera_rays;
      rays->bounce_rays += own.bounce_rays;
      rays->shadow_rays += own.shadow_rays;
    });
  }
  for (std::thread& thread : pool) thread.join();
  return merger.Picture();
}

double RelativeError(const FramePicture& picture, const LoadedPicture& reference) {
  constexpr double kOutliers = 0.001;
  std::vector<double> errors;
  const size_t stride = reference.channels.size();
  std::vector<size_t> channel;
  for (const char* name : {"R", "G", "B"}) {
    channel.push_back(static_cast<size_t>(
        std::find(reference.channels.begin(), reference.channels.end(), name) - reference.channels.begin()));
  }
  for (size_t pixel = 0; pixel < reference.values.size() / stride; ++pixel) {
    for (size_t c = 0; c < 3; ++c) {
      const double a = picture.values[pixel * 3 + c];
      const double b = reference.values[pixel * stride + channel[c]];
      errors.push_back((a - b) * (a - b) / (b * b + 0.01));
    }
  }
  std::sort(errors.begin(), errors.end());
  errors.resize(static_cast<size_t>(static_cast<double>(errors.size()) * (1 - kOutliers)));
  double sum = 0;
  for (double e : errors) sum += e;
  return sum / static_cast<double>(errors.size());
}

Result<Row> Measure(const std::string& pair, const BenchOptions& options) {
  const size_t equals = pair.find('=');
  if (equals == std::string::npos) return BadInput(pair + ": expected SCENE=REFERENCE.exr");
  const std::string path = pair.substr(0, equals);
  const Result<LoadedPicture> reference = LoadExr(pair.substr(equals + 1));
  if (!reference) return reference.error();
  const size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash);
  Row row;
  row.name = folder.substr(folder.rfind('/') + 1);
  for (int seed = 0; seed < options.seeds; ++seed) {
    DiskFileSource files(folder);
    RenderOptions render;
    render.samples_per_pixel = options.spp;
    render.width = reference->width;
    render.height = reference->height;
    render.seed = static_cast<uint64_t>(seed);
    render.accelerator = options.accelerator;
    const double load_start = CpuSeconds();
    const Result<std::unique_ptr<Scene>> scene =
        Scene::Load(files, path.substr(slash + 1), render, Scene::Depth::kRender);
    if (!scene) return scene.error();
    const double cpu_start = CpuSeconds(), wall_start = WallSeconds();
    const FramePicture picture = RenderWhole(**scene, options.threads, &row.rays);
    row.render_cpu += CpuSeconds() - cpu_start;
    row.render_wall += WallSeconds() - wall_start;
    row.load_seconds += cpu_start - load_start;
    const double noise = 1 + static_cast<double>((*scene)->frame().samples_per_pixel) / options.reference_spp;
    row.relmse += RelativeError(picture, *reference) / noise;
    row.paths += static_cast<uint64_t>(picture.bounds.area()) * (*scene)->frame().samples_per_pixel;
  }
  row.relmse /= options.seeds;
  row.load_seconds /= options.seeds;
  return row;
}

int Run(const BenchOptions& options) {
  std::string csv =
      "scene,load_cpu_s,render_cpu_s,render_wall_s,paths_per_cpu_s,rays_per_cpu_s,relmse,relmse_x_cpu_s\n";
  fmt::print(
      "| scene | load CPU s | CPU s | wall s | k paths/CPU s | M rays/CPU s | relMSE | relMSE x CPU s |\n");
  fmt::print("|---|---|---|---|---|---|---|---|\n");
  for (const std::string& pair : options.scenes) {
    const Result<Row> row = Measure(pair, options);
    if (!row) {
      fmt::print(stderr, "{}\n", row.error().message);
      return static_cast<int>(row.error().kind);
    }
    const double cpu = row->render_cpu / options.seeds, wall = row->render_wall / options.seeds;
    const double paths = static_cast<double>(row->paths) / row->render_cpu;
    const double rays = static_cast<double>(row->rays.rays()) / row->render_cpu;
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {:.2f} | {:.5f} | {:.4f} |\n", row->name,
               row->load_seconds, cpu, wall, paths / 1e3, rays / 1e6, row->relmse, row->relmse * cpu);
    std::fflush(stdout);
    csv += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.0f},{:.0f},{:.6f},{:.6f}\n", row->name, row->load_seconds,
                       cpu, wall, paths, rays, row->relmse, row->relmse * cpu);
  }
  if (!options.csv.empty()) {
    if (Result<void> written = WriteFileAtomically(options.csv, csv); !written) {
      fmt::print(stderr, "{}\n", written.error().message);
      return 1;
    }
  }
  return 0;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::BenchOptions options;
  CLI::App app("Speed and noise of the renderer, per scene");
  app.add_option("--spp", options.spp, "samples per pixel");
  app.add_option("--seeds", options.seeds, "renders per scene, averaged")->check(CLI::Range(1, 1000));
  app.add_option("--threads", options.threads, "render threads")->check(CLI::Range(1, 1024));
  app.add_option("--reference-spp", options.reference_spp, "samples per pixel of the references");
  app.add_option("--accelerator", options.accelerator, "as tessera render --accelerator");
  app.add_option("--csv", options.csv, "also write the table here");
  app.add_option("scenes", options.scenes, "SCENE=REFERENCE.exr ...")->required();
  CLI11_PARSE(app, argc, argv);
  return tessera::Run(options);
}
