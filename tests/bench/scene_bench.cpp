// Renders scenes on this machine and prints for each: seconds to load it and to build its accelerator, bytes
// per primitive, camera paths and rays per CPU second, where the time goes, the peak of memory, relMSE
// against a reference, and relMSE x CPU seconds, the figure to compare, as it does not depend on the number
// of samples.
//   scene_bench [--spp N] [--seeds K] [--threads T] [--csv FILE] [--instructions] SCENE=REFERENCE.exr ...
//   scene_bench --compare BEFORE.csv AFTER.csv
// The picture has the size of its reference. relMSE is the mean of (a - b)^2 / (b^2 + 0.01) over R, G and B
// without the largest 0.1 % of values. The noise of a single reference is divided out as 1 + spp / reference
// spp (--reference-spp); two independent references (SCENE=R.exr,S.exr) need no such estimate. A SCENE
// without a reference is only timed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "renderer/util/file.h"
#include "tests/bench/bench_table.h"
#include "tests/bench/frame_run.h"
#include "tests/bench/process_cost.h"
#include "tests/bench/time_profile.h"

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
  bool instructions = false;  // count them
  bool without_profile = false;
  std::string csv, accelerator, integrator, write;
  std::vector<std::string> scenes;
  std::vector<std::string> compare;  // two CSV files
};

// The sum of a figure over seeds, and of its squares.
struct SeedSum {
  double sum = 0, squares = 0;
  int count = 0;

  void Add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double Mean() const { return sum / count; }
  // The relative standard error of the mean; 0 if there is one seed.
  double Spread() const {
    if (count < 2 || !(sum > 0)) return 0;
    const double variance = std::max(0.0, squares / count - Mean() * Mean()) * count / (count - 1);
    return std::sqrt(variance / count) / Mean();
  }
};

struct SceneSums {
  SeedSum load_cpu, load_wall, build_wall, render_cpu, render_wall, relmse;
  uint64_t paths = 0, primitives = 0, scene_bytes = 0;
  RenderStatistics rays;
  TimeShares shares;  // sums over the seeds
  double peak_mb = 0;
  double instructions_per_path = 0;

  BenchRow Row(const std::string& scene) const;
};

BenchRow SceneSums::Row(const std::string& scene) const {
  const auto per_second = [this](uint64_t count) { return static_cast<double>(count) / render_cpu.sum; };
  const auto share = [this](TimePart part) { return shares.Of(part) / render_cpu.count; };
  const auto count = static_cast<double>(primitives);
  return {.scene = scene,
          .load_cpu_s = load_cpu.Mean(),
          .load_wall_s = load_wall.Mean(),
          .build_wall_s = build_wall.Mean(),
          .primitives = count,
          .bytes_per_primitive = count > 0 ? static_cast<double>(scene_bytes) / count : 0,
          .render_cpu_s = render_cpu.Mean(),
          .render_wall_s = render_wall.Mean(),
          .paths_per_cpu_s = per_second(paths),
          .camera_rays_per_cpu_s = per_second(rays.camera_rays),
          .bounce_rays_per_cpu_s = per_second(rays.bounce_rays),
          .shadow_rays_per_cpu_s = per_second(rays.shadow_rays),
          .instructions_per_path = instructions_per_path,
          .traversal_share = share(TimePart::kTraversal),
          .shapes_share = share(TimePart::kShapes),
          .shading_share = share(TimePart::kShading),
          .sampling_share = share(TimePart::kSampling),
          .textures_share = share(TimePart::kTextures),
          .lights_share = share(TimePart::kLights),
          .other_share = share(TimePart::kOther),
          .relmse = relmse.Mean(),
          .relmse_x_cpu_s = relmse.Mean() * render_cpu.Mean(),
          .load_spread = load_cpu.Spread(),
          .cpu_spread = render_cpu.Spread(),
          .relmse_spread = relmse.Spread(),
          .peak_mb = peak_mb};
}

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

void AddScene(const SceneSummary& summary, SceneSums* sums) {
  sums->primitives = 0;
  for (const PrimitiveTotal& each : summary.primitives) sums->primitives += each.count;
  const AcceleratorSummary& accelerator = summary.accelerators.at(0);
  sums->scene_bytes = summary.geometry_bytes + accelerator.bytes;
  sums->build_wall.Add(accelerator.build_seconds);
}

void AddRun(const Scene& scene, const FrameRun& run, SceneSums* sums) {
  sums->render_cpu.Add(run.cpu_seconds);
  sums->render_wall.Add(run.wall_seconds);
  sums->paths += static_cast<uint64_t>(run.picture.bounds.area()) * scene.frame().samples_per_pixel;
  sums->rays.camera_rays += run.rays.camera_rays;
  sums->rays.bounce_rays += run.rays.bounce_rays;
  sums->rays.shadow_rays += run.rays.shadow_rays;
}

Result<void> MeasureOnce(const SceneArgument& argument, const BenchOptions& options, uint64_t seed,
                         SceneSums* sums) {
  DiskFileSource files(argument.folder);
  const double load_start = CpuSeconds(), load_start_wall = WallSeconds();
  const Result<std::unique_ptr<Scene>> loaded = Scene::Load(
      files, argument.file, RenderOptionsFor(options, argument.references, seed), Scene::Depth::kRender);
  if (!loaded) return loaded.error();
  const Scene& scene = **loaded;
  const double load_seconds = CpuSeconds() - load_start;
  sums->load_cpu.Add(load_seconds);
  sums->load_wall.Add(WallSeconds() - load_start_wall);
  AddScene(scene.summary(), sums);
  std::optional<TimeProfiler> profiler;
  if (!options.without_profile) profiler.emplace();
  const FrameRun run = RenderWhole(scene, options.threads);
  sums->peak_mb = PeakMemory();  // before addresses are looked up
  if (profiler) {
    const auto shares = profiler->Finish();
    if (!shares) return shares.error();
    for (size_t i = 0; i < kTimeParts; ++i) sums->shares.of[i] += shares->of[i];
  }
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
  sums->relmse.Add(error.trimmed / noise);
  AddRun(scene, run, sums);
  return {};
}

// Of a small picture. What loading takes, and what differs between starts, is in the counts of both runs.
Result<double> InstructionsPerPath(const std::string& scene, const BenchOptions& options) {
  constexpr int kWidth = 64, kHeight = 48, kFewSamples = 1, kManySamples = 9;
  std::array<double, 2> counts{};
  for (const int samples : {kFewSamples, kManySamples}) {
    std::vector<std::string> arguments{"--threads", "1",
                                       "--width",   std::to_string(kWidth),
                                       "--height",  std::to_string(kHeight),
                                       "--spp",     std::to_string(samples)};
    if (!options.accelerator.empty())
      arguments.insert(arguments.end(), {"--accelerator", options.accelerator});
    if (!options.integrator.empty()) arguments.insert(arguments.end(), {"--integrator", options.integrator});
    arguments.push_back("--without-profile");
    arguments.push_back(scene);
    const auto count = CountInstructions(arguments);
    if (!count) return count.error();
    counts[samples == kFewSamples ? 0 : 1] = static_cast<double>(*count);
  }
  return (counts[1] - counts[0]) / (double{kWidth} * kHeight * (kManySamples - kFewSamples));
}

Result<BenchRow> Measure(const std::string& text, const BenchOptions& options) {
  const Result<SceneArgument> argument = SceneArgument::Read(text);
  if (!argument) return argument.error();
  SceneSums sums;
  ResetPeakMemory();
  for (int i = 0; i < options.seeds; ++i) {
    const uint64_t seed = options.first_seed + static_cast<uint64_t>(i);
    if (Result<void> measured = MeasureOnce(*argument, options, seed, &sums); !measured)
      return measured.error();
  }
  if (options.instructions) {
    const auto counted = InstructionsPerPath(text.substr(0, text.find('=')), options);
    if (!counted) return counted.error();
    sums.instructions_per_path = *counted;
  }
  return sums.Row(argument->folder.substr(argument->folder.rfind('/') + 1));
}

void PrintRow(const BenchRow& row) {
  const auto percent = [](double share) { return fmt::format("{:.0f}", 100 * share); };
  fmt::print(
      "| {} | {:.2f} | {:.2f} | {:.0f} | {:.2f} | {:.2f} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {} | "
      "{} "
      "| {} | {} | {} | {} | {} | {:.5f} | {:.4f} | {:.0f} |\n",
      row.scene, row.load_cpu_s, row.build_wall_s, row.bytes_per_primitive, row.render_cpu_s,
      row.render_wall_s, row.paths_per_cpu_s / 1e3, row.camera_rays_per_cpu_s / 1e6,
      row.bounce_rays_per_cpu_s / 1e6, row.shadow_rays_per_cpu_s / 1e6, row.instructions_per_path,
      percent(row.traversal_share), percent(row.shapes_share), percent(row.shading_share),
      percent(row.sampling_share), percent(row.textures_share), percent(row.lights_share),
      percent(row.other_share), row.relmse, row.relmse_x_cpu_s, row.peak_mb);
  std::fflush(stdout);
}

constexpr const char* kTableHead =
    "| scene | load CPU s | build s | bytes/primitive | CPU s | wall s | k paths/CPU s | M camera rays/CPU s "
    "| M bounce rays/CPU s | M shadow rays/CPU s | instructions/path | % traversal | % shapes | % shading "
    "| % sampling | % textures | % lights | % other | relMSE | relMSE x CPU s | peak MB |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

int Fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.message);
  return static_cast<int>(error.kind);
}

int Run(const BenchOptions& options) {
  if (!options.json) fmt::print("{}", kTableHead);
  std::vector<BenchRow> rows;
  for (const std::string& scene : options.scenes) {
    const Result<BenchRow> row = Measure(scene, options);
    if (!row) return Fail(row.error());
    if (!options.json) PrintRow(*row);
    rows.push_back(*row);
  }
  if (options.csv.empty()) return 0;
  const Result<void> written = WriteFileAtomically(options.csv, ToCsv(rows));
  return written ? 0 : Fail(written.error());
}

Result<std::vector<BenchRow>> LoadBench(const std::string& path) {
  constexpr uint64_t kSizeMax = 1 << 20;
  const Result<std::string> text = ReadFile(path, kSizeMax);
  if (!text) return text.error();
  Result<std::vector<BenchRow>> rows = ReadBenchCsv(*text);
  if (!rows) return BadInput(path + ": " + rows.error().message);
  return rows;
}

int CompareFiles(const std::vector<std::string>& files) {
  const Result<std::vector<BenchRow>> before = LoadBench(files[0]);
  if (!before) return Fail(before.error());
  const Result<std::vector<BenchRow>> after = LoadBench(files[1]);
  if (!after) return Fail(after.error());
  fmt::print("{}", CompareBenches(*before, *after));
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
  app.add_flag("--instructions", options.instructions,
               "Also count instructions per camera path with valgrind, which takes minutes");
  app.add_flag("--without-profile", options.without_profile, "Do not sample where the time goes");
  app.add_option("--write", options.write, "Write the last picture to this EXR file");
  app.add_option("--csv", options.csv, "Also write the table to this CSV file");
  auto* compare =
      app.add_option("--compare", options.compare,
                     "Render nothing: compare two CSV files, scene by scene; more than 1 is better, ~ "
                     "marks what noise explains")
          ->expected(2);
  app.add_option("scenes", options.scenes, "SCENE or SCENE=REFERENCE.exr[,REFERENCE.exr] ...")
      ->excludes(compare);
  CLI11_PARSE(app, argc, argv);
  if (!options.compare.empty()) return tessera::CompareFiles(options.compare);
  if (options.scenes.empty()) {
    fmt::print(stderr, "scene_bench: name a scene, or two CSV files with --compare\n");
    return 2;
  }
  return tessera::Run(options);
}
