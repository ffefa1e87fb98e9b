// What a coordinator alone can take: results per second and megabytes per second that it checks, merges and
// writes to disk before it answers, and the memory that it needs, from 10 to 1,000 workers that return
// made-up tiles over real connections on this machine. The generator shares the cores with what it measures.
// With --compare-tls, what the encryption of connections costs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include "renderer/scene/layers.h"
#include "tests/bench/bench_farm.h"
#include "tests/bench/synthetic_workers.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

struct Plan {
  std::vector<int> connections{10, 100, 1000};
  double seconds = 10;
  int slots = 4;
  std::string resolution = "1920x1080";
  std::string layers;  // --aov
  bool tls = false;
  int rounds = 0;  // of plain and encrypted connections in turn; 0: no comparison
  bool csv = false;
};

constexpr double kUnitSeconds = 1;  // the scheduler cuts no unit into fewer than one sample

void Submit(const Plan& plan, const BenchFarm& farm) {
  const std::string scene = farm.folder() + "/scene.pbrt";
  std::ofstream(scene) << "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n";
  std::vector<std::string> words{"submit",      scene, "--spp",        "1048576",
                                 "--tile-size", "64",  "--resolution", plan.resolution};
  if (!plan.layers.empty()) words.insert(words.end(), {"--aov", plan.layers});
  const Outcome outcome = farm.Tessera(words);
  if (outcome.code != 0) throw std::runtime_error("submit failed: " + outcome.errors);
}

// Of the frame that is submitted: nothing in it moves or has a group.
PixelShape ShapeOf(const Plan& plan) {
  std::vector<Channel> channels = ColorsAndWeight({"R", "G", "B"});
  std::set<std::string> names;
  std::istringstream words(plan.layers);
  for (std::string name; std::getline(words, name, ',');) names.insert(name);
  AddLayers(ExpandLayers(names, false, false), channels);
  return ChannelLayout(channels, false).shape();
}

LoadCounts Since(const LoadCounts& then, const LoadCounts& now) {
  return {now.results - then.results, now.accepted - then.accepted, now.bytes - then.bytes,
          now.calls - then.calls};
}

struct Measured {
  double results_per_s = 0;
  double coordinator_ms = 0;  // CPU time for each result
};

Measured Measure(const Plan& plan, int connections, Security security) {
  BenchFarm farm(security);
  const pid_t coordinator = farm.coordinator().pid();
  const double idle_megabytes = UsageOf(coordinator).megabytes;
  Submit(plan, farm);
  SyntheticWorkers workers(farm.Join(Role::kWorker), connections, plan.slots, kUnitSeconds, ShapeOf(plan));
  const auto half = std::chrono::duration<double>(plan.seconds / 2);
  std::this_thread::sleep_for(half);  // everybody is connected, every tile has been begun
  const LoadCounts before = workers.counts();
  const Usage usage_before = UsageOf(coordinator);
  const auto begin = Clock::now();
  std::this_thread::sleep_for(2 * half);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  const LoadCounts counts = Since(before, workers.counts());
  const Usage usage = UsageOf(coordinator);
  if (!workers.error().empty()) throw std::runtime_error(workers.error());
  const double cpu_s = usage.cpu_s - usage_before.cpu_s;
  const auto results = static_cast<double>(counts.results);
  fmt::print(
      fmt::runtime(plan.csv ? "{},{},{:.0f},{:.1f},{:.3f},{:.1f},{:.1f},{:.1f},{:.1f},{},{:.1f},{:.4f}\n"
                            : "{:11}  {:5}  {:9.0f}  {:6.1f}  {:11.3f}  {:7.1f}  {:10.1f}  {:8.1f}  {:7.1f}  "
                              "{:9}  {:12.1f}  {:8.4f}\n"),
      connections, security == Security::kTls ? "tls" : "plain", results / seconds,
      static_cast<double>(counts.bytes) / 1e6 / seconds, cpu_s / seconds, idle_megabytes,
      usage_before.megabytes, usage.megabytes, MegabytesIn(farm.folder() + "/data"), workers.counts().results,
      results / static_cast<double>(counts.calls), static_cast<double>(counts.accepted) / results);
  std::fflush(stdout);
  return {results / seconds, 1e3 * cpu_s / results};
}

double MedianRatio(const std::vector<Measured>& plain, const std::vector<Measured>& tls,
                   double Measured::*what) {
  std::vector<double> ratios;
  for (size_t i = 0; i < plain.size(); ++i) ratios.push_back(tls[i].*what / (plain[i].*what));
  std::ranges::sort(ratios);
  const size_t half = ratios.size() / 2;
  return ratios.size() % 2 == 1 ? ratios[half] : (ratios[half - 1] + ratios[half]) / 2;
}

// Both in turn, and each first as often as the other, as the machine may become slower or faster meanwhile.
void Compare(const Plan& plan, int connections) {
  std::vector<Measured> plain, tls;
  for (int round = 0; round < plan.rounds; ++round) {
    const bool tls_first = round % 2 == 1;
    if (tls_first) tls.push_back(Measure(plan, connections, Security::kTls));
    plain.push_back(Measure(plan, connections, Security::kPlain));
    if (!tls_first) tls.push_back(Measure(plan, connections, Security::kTls));
  }
  fmt::print(
      "tls/plain with {} connections, median of {} pairs: {:.3f} of the results/s, {:.3f} of the "
      "coordinator's CPU "
      "time per result\n",
      connections, plan.rounds, MedianRatio(plain, tls, &Measured::results_per_s),
      MedianRatio(plain, tls, &Measured::coordinator_ms));
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::Plan plan;
  CLI::App app("a coordinator under the load of made-up results");
  app.add_option("--connections", plan.connections, "synthetic workers, each with a connection of its own")
      ->check(CLI::Range(1, 20'000));
  app.add_option("--seconds", plan.seconds, "to measure each, after half of it to warm up")
      ->check(CLI::Range(1.0, 86'400.0));
  app.add_option("--slots", plan.slots, "of each worker")->check(CLI::Range(1, 1024));
  app.add_option("--resolution", plan.resolution, "of the frame, in tiles of 64 x 64 pixels");
  app.add_option("--aov", plan.layers, "layers of the frame, as tessera render takes them");
  app.add_flag("--tls", plan.tls, "encrypted connections");
  app.add_option("--compare-tls", plan.rounds,
                 "measure plain and encrypted connections this many times in turn")
      ->check(CLI::Range(1, 1000));
  app.add_flag("--csv", plan.csv, "values separated by commas");
  CLI11_PARSE(app, argc, argv);
  using tessera::Security;
  try {
    fmt::print("{}",
               plan.csv
                   ? "connections,security,results_per_s,mb_per_s,coordinator_cores,idle_mb,early_mb,late_mb,"
                     "disk_mb,results,results_per_call,accepted\n"
                   : "connections  TLS?   results/s    MB/s  coord.cores  idle MB  early MB"
                     "   late MB  disk MB    results  results/call  accepted\n");
    for (const int connections : plan.connections) {
      if (plan.rounds > 0) {
        tessera::Compare(plan, connections);
      } else {
        tessera::Measure(plan, connections, plan.tls ? Security::kTls : Security::kPlain);
      }
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "load_generator: {}\n", error.what());
    return 1;
  }
  return 0;
}
