// Renders scenes on this machine and prints for each: load seconds, camera paths and rays per CPU second,
// relMSE against a reference, and relMSE x CPU seconds, the figure to compare, as it does not depend on the
// number of samples. Usage:
//   scene_bench [--spp N] [--seeds K] [--threads T] [--csv FILE] SCENE=REFERENCE.exr ...
// The picture has the size of its reference. relMSE is the mean of (a - b)^2 / (b^2 + 0.01) over R, G and B
// without the largest 0.1 % of values. The noise of a single reference is divided out as 1 + spp / reference
// spp
// (--reference-spp); two independent references (SCENE=R.exr,S.exr) need no such estimate. A SCENE without a
// reference is only timed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "renderer/util/file.h"
#include "tests/bench/frame_run.h"

namespace tessera {
namespace {

struct BenchOptions {
  uint32_t spp = 64;
  int seeds = 1;
  uint64_t first_seed = 0;
  int threads = 2;
  int width = 0, height = 0;  // 0: those of the reference if there is one, otherwise those of the scene
  int max_depth = -1;
  double reference_spp = 512;
  bool json = false;
  std::string csv, accelerator, integrator, write;
  std::vector<std::string> scenes;
};

struct Row {
  std::string name;
  double load_seconds = 0, render_wall = 0, render_cpu = 0;
  double relmse = 0;
  uint64_t paths = 0;
  RenderStatistics rays;
};

// SCENE or SCENE=REFERENCES.
struct SceneArgument {
  std::string folder, file;
  References references;

  static Result<SceneArgument> Read(const std::string& text);
};

Result<SceneArgument> SceneArgument::Read(const std::string& text) {
  SceneArgument argument;
  const size_t equals = text.find('=');
  const std::string path = text.substr(0, equals);
  const size_t slash = path.rfind('/');
  argument.folder = slash == std::string::npos ? "." : path.substr(0, slash);
  argument.file = slash == std::string::npos ? path : path.substr(slash + 1);
  if (equals == std::string::npos) return argument;
  Result<References> references = References::Load(text.substr(equals + 1));
  if (!references) return references.error();
  argument.references = std::move(*references);
  return argument;
}

RenderOptions RenderOptionsFor(const BenchOptions& options, const References& references, uint64_t seed) {
  RenderOptions render;
  render.samples_per_pixel = options.spp;
  render.seed = seed;
  render.accelerator = options.accelerator;
  render.integrator = options.integrator;
  if (options.max_depth >= 0) render.max_depth = options.max_depth;
  render.exr_type = ExrType::kFloat;
  if (options.width > 0) {
    render.width = options.width;
    render.height = options.height;
  } else if (!references.pictures.empty()) {
    render.width = references.pictures[0].width;
    render.height = references.pictures[0].height;
  }
  return render;
}

void PrintJson(const SceneArgument& argument, const Scene& scene, const FrameRun& run,
               const RelativeError& error, double load_seconds) {
  const nlohmann::json line = {{"scene", argument.file},
                               {"integrator", scene.summary().integrator},
                               {"accelerator", scene.summary().accelerator},
                               {"spp", scene.frame().samples_per_pixel},
                               {"width", scene.frame().width},
                               {"height", scene.frame().height},
                               {"load_cpu_s", load_seconds},
                               {"build_s", scene.summary().accelerators.at(0).build_seconds},
                               {"cpu_s", run.cpu_seconds},
                               {"wall_s", run.wall_seconds},
                               {"camera_rays", run.rays.camera_rays},
                               {"bounce_rays", run.rays.bounce_rays},
                               {"shadow_rays", run.rays.shadow_rays},
                               {"discarded_samples", run.rays.discarded_samples},
                               {"relmse", error.all},
                               {"relmse_trimmed", error.trimmed},
                               {"relmse_reference", error.reference}};
  fmt::print("{}\n", line.dump());
  std::fflush(stdout);
}

Result<void> MeasureOnce(const SceneArgument& argument, const BenchOptions& options, uint64_t seed,
                         Row* row) {
  DiskFileSource files(argument.folder);
  const double load_start = CpuSeconds();
  const Result<std::unique_ptr<Scene>> loaded = Scene::Load(
      files, argument.file, RenderOptionsFor(options, argument.references, seed), Scene::Depth::kRender);
  if (!loaded) return loaded.error();
  const Scene& scene = **loaded;
  const double load_seconds = CpuSeconds() - load_start;
  const FrameRun run = RenderWhole(scene, options.threads);
  RelativeError error;
  if (!argument.references.pictures.empty()) error = RelativeErrorOf(run.picture, argument.references);
  if (options.json) PrintJson(argument, scene, run, error, load_seconds);
  if (!options.write.empty()) {
    const Result<std::string> bytes = EncodeExr(scene.frame(), run.picture);
    if (!bytes) return bytes.error();
    if (Result<void> written = WriteFileAtomically(options.write, *bytes); !written) return written;
  }
  const uint32_t spp = scene.frame().samples_per_pixel;
  const double noise = argument.references.pictures.size() == 1 ? 1 + spp / options.reference_spp : 1;
  row->load_seconds += load_seconds / options.seeds;
  row->render_cpu += run.cpu_seconds;
  row->render_wall += run.wall_seconds;
  row->relmse += error.trimmed / noise / options.seeds;
  row->paths += static_cast<uint64_t>(run.picture.bounds.area()) * spp;
  row->rays.camera_rays += run.rays.camera_rays;
  row->rays.bounce_rays += run.rays.bounce_rays;
  row->rays.shadow_rays += run.rays.shadow_rays;
  return {};
}

Result<Row> Measure(const std::string& text, const BenchOptions& options) {
  const Result<SceneArgument> argument = SceneArgument::Read(text);
  if (!argument) return argument.error();
  Row row;
  row.name = argument->folder.substr(argument->folder.rfind('/') + 1);
  for (int i = 0; i < options.seeds; ++i) {
    const uint64_t seed = options.first_seed + static_cast<uint64_t>(i);
    if (Result<void> measured = MeasureOnce(*argument, options, seed, &row); !measured)
      return measured.error();
  }
  return row;
}

int Run(const BenchOptions& options) {
  std::string csv =
      "scene,load_cpu_s,render_cpu_s,render_wall_s,paths_per_cpu_s,rays_per_cpu_s,relmse,relmse_x_cpu_s\n";
  if (!options.json) {
    fmt::print(
        "| scene | load CPU s | CPU s | wall s | k paths/CPU s | M rays/CPU s | relMSE | relMSE x CPU s |\n");
    fmt::print("|---|---|---|---|---|---|---|---|\n");
  }
  for (const std::string& scene : options.scenes) {
    const Result<Row> row = Measure(scene, options);
    if (!row) {
      fmt::print(stderr, "{}\n", row.error().message);
      return static_cast<int>(row.error().kind);
    }
    const double cpu = row->render_cpu / options.seeds, wall = row->render_wall / options.seeds;
    const double paths = static_cast<double>(row->paths) / row->render_cpu;
    const double rays = static_cast<double>(row->rays.rays()) / row->render_cpu;
    if (!options.json) {
      fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {:.2f} | {:.5f} | {:.4f} |\n", row->name,
                 row->load_seconds, cpu, wall, paths / 1e3, rays / 1e6, row->relmse, row->relmse * cpu);
      std::fflush(stdout);
    }
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
  CLI::App app("Measure speed and noise of the renderer, per scene");
  app.add_option("--spp", options.spp, "Samples per pixel");
  app.add_option("--seeds", options.seeds, "Renders per scene, which are averaged")
      ->check(CLI::Range(1, 1000));
  app.add_option("--first-seed", options.first_seed, "Seed of the first render");
  app.add_option("--threads", options.threads, "Number of render threads")->check(CLI::Range(1, 1024));
  app.add_option("--reference-spp", options.reference_spp,
                 "Samples per pixel of a single reference [default: 512]");
  app.add_option("--accelerator", options.accelerator, "See tessera render --accelerator");
  app.add_option("--integrator", options.integrator, "See tessera render --integrator");
  app.add_option("--max-depth", options.max_depth, "See tessera render --max-depth");
  app.add_option("--width", options.width, "Width of the picture; requires --height");
  app.add_option("--height", options.height, "Height of the picture; requires --width");
  app.add_flag("--json", options.json, "Print one JSON line per run instead of a table");
  app.add_option("--write", options.write, "Write the last picture to this EXR file");
  app.add_option("--csv", options.csv, "Also write the table to this CSV file");
  app.add_option("scenes", options.scenes, "SCENE or SCENE=REFERENCE.exr[,REFERENCE.exr] ...")->required();
  CLI11_PARSE(app, argc, argv);
  return tessera::Run(options);
}
