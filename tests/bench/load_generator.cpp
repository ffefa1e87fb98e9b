// What a coordinator alone can take: results per second and megabytes per second that it checks, merges and
// writes to disk before it answers, and the memory that it needs, from 10 to 1,000 workers that return
// made-up tiles over real connections on this machine. The generator shares the cores with what it measures.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/bench/synthetic_workers.h"
#include "tests/end_to_end/process.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

struct Plan {
  std::vector<int> connections{10, 100, 1000};
  double seconds = 10;
  int slots = 4;
  std::string resolution = "1920x1080";
  bool csv = false;
};

constexpr double kUnitSeconds = 1;  // the scheduler cuts no unit into fewer than one sample

// Of a process: kilobytes that it holds in memory, CPU seconds that it has used.
struct Usage {
  double megabytes = 0, cpu_s = 0;
};

Usage UsageOf(pid_t pid) {
  Usage usage;
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string word; status >> word;) {
    if (word == "VmRSS:" && status >> usage.megabytes) usage.megabytes /= 1024;
  }
  std::ifstream stat(fmt::format("/proc/{}/stat", pid));
  std::string word;
  double ticks = 0;
  for (int field = 1; stat >> word; ++field) {
    if (field == 14 || field == 15) ticks += std::stod(word);
  }
  usage.cpu_s = ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
  return usage;
}

double MegabytesIn(const std::string& folder) {
  uint64_t bytes = 0;
  std::error_code ignored;  // files come and go meanwhile
  for (std::filesystem::recursive_directory_iterator at(folder, ignored), end; at != end;
       at.increment(ignored))
    if (at->is_regular_file(ignored)) bytes += at->file_size(ignored);
  return static_cast<double>(bytes) / 1e6;
}

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "tessera-load-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder can be made");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string AwaitAddress(Process& coordinator) {
  const std::string words = "listening on ";
  if (!coordinator.AwaitErrors(words)) throw std::runtime_error("no coordinator: " + coordinator.Errors());
  const std::string log = coordinator.Errors();
  const size_t begin = log.find(words) + words.size();
  return log.substr(begin, log.find('\n', begin) - begin);
}

void Submit(const Plan& plan, const std::string& folder, const std::string& address) {
  std::ofstream(folder + "/scene.pbrt") << "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n";
  const Outcome outcome = RunProgram(folder, "tessera",
                                     {"submit", folder + "/scene.pbrt", "--coordinator", address, "--spp",
                                      "1048576", "--tile-size", "64", "--resolution", plan.resolution});
  if (outcome.code != 0) throw std::runtime_error("submit failed: " + outcome.errors);
}

LoadCounts Since(const LoadCounts& then, const LoadCounts& now) {
  return {now.results - then.results, now.accepted - then.accepted, now.bytes - then.bytes,
          now.calls - then.calls};
}

void Measure(const Plan& plan, int connections) {
  const Folder folder;
  Process coordinator(folder.path(), "tessera-coordinator",
                      {"--listen", "127.0.0.1:0", "--insecure", "--data-dir", folder.path() + "/data"});
  const std::string address = AwaitAddress(coordinator);
  const double idle_megabytes = UsageOf(coordinator.pid()).megabytes;
  Submit(plan, folder.path(), address);
  SyntheticWorkers workers(ParseAddress(address, "coordinator").value(), connections, plan.slots,
                           kUnitSeconds);
  const auto half = std::chrono::duration<double>(plan.seconds / 2);
  std::this_thread::sleep_for(half);  // everybody is connected, every tile has been begun
  const LoadCounts before = workers.counts();
  const Usage usage_before = UsageOf(coordinator.pid());
  const auto begin = Clock::now();
  std::this_thread::sleep_for(2 * half);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  const LoadCounts counts = Since(before, workers.counts());
  const Usage usage = UsageOf(coordinator.pid());
  if (!workers.error().empty()) throw std::runtime_error(workers.error());
  fmt::print(
      fmt::runtime(plan.csv ? "{},{:.0f},{:.1f},{:.3f},{:.1f},{:.1f},{:.1f},{:.1f},{},{:.1f},{:.4f}\n"
                            : "{:11}  {:9.0f}  {:6.1f}  {:11.3f}  {:7.1f}  {:10.1f}  {:8.1f}  {:7.1f}  "
                              "{:9}  {:12.1f}  {:8.4f}\n"),
      connections, static_cast<double>(counts.results) / seconds,
      static_cast<double>(counts.bytes) / 1e6 / seconds, (usage.cpu_s - usage_before.cpu_s) / seconds,
      idle_megabytes, usage_before.megabytes, usage.megabytes, MegabytesIn(folder.path() + "/data"),
      workers.counts().results, static_cast<double>(counts.results) / static_cast<double>(counts.calls),
      static_cast<double>(counts.accepted) / static_cast<double>(counts.results));
  std::fflush(stdout);
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
  app.add_flag("--csv", plan.csv, "values separated by commas");
  CLI11_PARSE(app, argc, argv);
  try {
    fmt::print("{}", plan.csv
                         ? "connections,results_per_s,mb_per_s,coordinator_cores,idle_mb,early_mb,late_mb,"
                           "disk_mb,results,results_per_call,accepted\n"
                         : "connections  results/s    MB/s  coord.cores  idle MB  early MB"
                           "   late MB  disk MB    results  results/call  accepted\n");
    for (const int connections : plan.connections) tessera::Measure(plan, connections);
  } catch (const std::exception& error) {
    fmt::print(stderr, "load_generator: {}\n", error.what());
    return 1;
  }
  return 0;
}
