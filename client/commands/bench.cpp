// tessera bench
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "client/bench_scene.h"
#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/in_process.h"
#include "client/scene_frames.h"
#include "proto/shell/console.h"
#include "renderer/util/cores.h"

namespace tessera {
namespace {

constexpr int kBenchSecondsDefault = 10, kBenchSecondsMax = 3600;
constexpr int kBenchThreadsMax = 1024;
constexpr double kSamplesPerPoint = 1000;  // pixel samples per second that make one point

struct BenchOptions {
  int seconds = kBenchSecondsDefault;
  int threads = 0;  // 0: all cores
  bool json = false;
};

void AddBenchFlags(CLI::App& app, BenchOptions& options) {
  AddInteger(app, "--seconds",
             WithDefault("Seconds to render at least", std::to_string(kBenchSecondsDefault)), 1,
             kBenchSecondsMax, options.seconds);
  AddInteger(app, "--threads", WithDefault("Render threads", "all cores"), 1, kBenchThreadsMax,
             options.threads);
  AddJsonFlag(app, options.json);
}

// The median of the samples per second of whole pictures. The first picture is not counted: caches are cold
// and the processor may not run at full speed yet.
Result<double> Measure(const Scene& scene, const BenchOptions& options, int threads,
                       Cancellation& cancellation) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(options.seconds);
  std::vector<double> speeds;
  for (int round = 0; round < 2 || Clock::now() < end; ++round) {
    double speed = 0;
    const auto picture =
        RenderInProcess(scene, scene.frame(), threads, cancellation.token(),
                        [&speed](const Progress& progress) { speed = progress.samples_per_second; });
    if (!picture) return picture.error();
    if (round > 0) speeds.push_back(speed);
  }
  std::ranges::nth_element(speeds, speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2));
  return speeds[speeds.size() / 2];
}

Result<int> RunBench(const BenchOptions& options, Cancellation& cancellation) {
  SceneFrame frame;
  frame.path = "bench.pbrt";
  frame.text = std::make_shared<const std::string>(BenchScene());
  const auto loaded = LoadFrame(frame, Scene::Depth::kRender, nullptr);
  if (!loaded) return loaded.error();
  const int threads = options.threads > 0 ? options.threads : UsableCores();
  const auto speed = Measure(*loaded->scene, options, threads, cancellation);
  if (!speed) return speed.error();
  const double score = *speed / kSamplesPerPoint;
  if (options.json) {
    const nlohmann::ordered_json json{{"score", score},
                                      {"benchmark", kBenchVersion},
                                      {"threads", threads},
                                      {"samples_per_second", *speed},
                                      {"software_version", kSoftwareVersion}};
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print("{:.0f}\n", score);
    PrintNote("benchmark {} with {} thread{}: {:.0f} samples/s; larger is faster\n", kBenchVersion, threads,
              threads == 1 ? "" : "s", *speed);
  }
  return 0;
}

}  // namespace

Command BenchCommand() {
  return MakeCommand<BenchOptions>({
      .name = "bench",
      .summary = "Measure how fast this machine renders, as one number",
      .examples = {{"Print the score of this machine", "tessera bench"},
                   {"Measure one core", "tessera bench --threads 1"}},
      .add_flags = AddBenchFlags,
      .run = RunBench,
  });
}

}  // namespace tessera
