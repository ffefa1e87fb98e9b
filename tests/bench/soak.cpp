// A farm over a long time: synthetic workers, clients that come and go, and a flood of peers that do not
// belong to it. Prints what the coordinator holds, and checks that every job gives the picture that it gave
// on the quiet farm. Exits with 1 if a picture differs, a client fails, a stranger is answered, memory still
// grows after the coordinator has warmed up, or connections of those who have left stay open.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <sstream>
#include <thread>

#include "renderer/util/digest.h"
#include "tests/bench/bench_farm.h"
#include "tests/bench/flood.h"
#include "tests/bench/synthetic_workers.h"
#include "tests/end_to_end/process.h"
#include "tests/sanitizers.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

struct Plan {
  double minutes = 10;
  int workers = 200;
  int clients = 50;
  int flood = 300;
  double growth_mb = 48;  // that is accepted after warming up
};

constexpr double kUnitSeconds = 0.01;
constexpr double kWarmUp = 0.3;    // of the time
constexpr int kRestMax_ms = 4000;  // of a client between two jobs
constexpr int kFailuresPrinted = 20;
// More than on the quiet farm after all have left: files and connections that come and go without clients.
constexpr size_t kDescriptorsAccepted = 32;
constexpr std::chrono::seconds kClosingMax{60};  // from then on until the last connection is closed

Digest DigestOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return Sha256(text.str());
}

// What the clients have done so far. Thread safe.
class Record {
 public:
  void Finished() {
    const std::lock_guard lock(mutex_);
    ++finished_;
  }
  void Failed(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (++failed_ <= kFailuresPrinted) fmt::print(stderr, "{}\n", why);
  }
  int finished() const {
    const std::lock_guard lock(mutex_);
    return finished_;
  }
  int failed() const {
    const std::lock_guard lock(mutex_);
    return failed_;
  }

 private:
  mutable std::mutex mutex_;
  int finished_ = 0, failed_ = 0;  // guarded by mutex_
};

// Submits a job, waits for it and fetches its picture. Returns the digest of it, or an empty optional with
// `why` set.
std::optional<Digest> RunJob(const BenchFarm& farm, const std::string& name, std::string& why) {
  const std::string picture = farm.folder() + "/" + name + ".exr";
  const Outcome submitted =
      farm.Tessera({"submit", farm.folder() + "/scene.pbrt", "--name", name, "--watch", "--spp", "16",
                    "--resolution", "192x128", "--tile-size", "64", "--patience", "60"});
  const std::string job = submitted.output.substr(0, submitted.output.find('\n'));
  if (submitted.code != 0) {
    why = fmt::format("{}: submit: {}", name, submitted.errors);
    return std::nullopt;
  }
  const Outcome fetched = farm.Tessera({"fetch", job, "-o", picture, "--patience", "60"});
  if (fetched.code != 0) {
    why = fmt::format("{}: fetch {}: {}", name, job, fetched.errors);
    return std::nullopt;
  }
  const Digest digest = DigestOf(picture);
  std::filesystem::remove(picture);
  return digest;
}

// Outputs of programs that have ended: one for each run.
void RemoveLogs(const std::string& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename();
    const auto age = std::filesystem::file_time_type::clock::now() - entry.last_write_time(ignored);
    if (name.starts_with("tessera-") && name.find("coordinator") == std::string::npos &&
        age > std::chrono::minutes(5))
      std::filesystem::remove(entry.path(), ignored);
  }
}

void ComeAndGo(std::stop_token stop, const BenchFarm& farm, int index, const Digest& expected,
               Record& record) {
  std::mt19937 random(static_cast<unsigned>(index) + 1);
  for (int round = 0; !stop.stop_requested(); ++round) {
    std::string why;
    const auto digest = RunJob(farm, fmt::format("client-{}-{}", index, round), why);
    if (!digest) {
      record.Failed(why);
    } else if (*digest != expected) {
      record.Failed(fmt::format("client-{}-{}: the picture differs", index, round));
    } else {
      record.Finished();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % kRestMax_ms));
  }
}

struct Growth {
  double warm_megabytes = 0, most_megabytes = 0;  // when warm, and ever
};

// Looks at the coordinator until the time is over, and prints what it sees.
Growth Observe(const Plan& plan, BenchFarm& farm, const SyntheticWorkers& workers, const Flood& flood,
               const Record& record) {
  fmt::print("seconds  RSS MB  descriptors  disk MB  jobs right  wrong  results  strangers  refused\n");
  const auto begin = Clock::now();
  const double seconds_total = plan.minutes * 60;
  const double step = std::min(10.0, seconds_total / 12);
  Growth growth;
  for (double next = step; next <= seconds_total; next += step) {
    std::this_thread::sleep_until(
        begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(next)));
    RemoveLogs(farm.folder());
    const Usage usage = UsageOf(farm.coordinator().pid());
    fmt::print("{:7.0f}  {:6.1f}  {:11}  {:7.1f}  {:10}  {:5}  {:7}  {:9}  {:7}\n", next, usage.megabytes,
               usage.descriptors, MegabytesIn(farm.folder() + "/data"), record.finished(), record.failed(),
               workers.counts().results, flood.opened(), flood.refused());
    std::fflush(stdout);
    growth.most_megabytes = std::max(growth.most_megabytes, usage.megabytes);
    if (next < kWarmUp * seconds_total) growth.warm_megabytes = growth.most_megabytes;
  }
  return growth;
}

bool Soak(const Plan& plan) {
  BenchFarm farm(Security::kTls);
  std::ofstream(farm.folder() + "/scene.pbrt")
      << "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n";
  const SyntheticWorkers workers(farm.Join(Role::kWorker), plan.workers, 2, kUnitSeconds);
  std::string why;
  const auto expected = RunJob(farm, "quiet", why);
  if (!expected) throw std::runtime_error(why);
  const auto descriptors = [&] { return UsageOf(farm.coordinator().pid()).descriptors; };
  const size_t quiet_descriptors = descriptors();
  Record record;
  Flood flood(ParseAddress(farm.address(), "coordinator").value(), plan.flood);
  Growth growth;
  {
    std::vector<std::jthread> clients;
    for (int i = 0; i < plan.clients; ++i)
      clients.emplace_back([&, i](std::stop_token stop) { ComeAndGo(stop, farm, i, *expected, record); });
    growth = Observe(plan, farm, workers, flood, record);
    for (std::jthread& each : clients) each.request_stop();
  }
  flood.Stop();
  const bool is_closed =
      Eventually([&] { return descriptors() <= quiet_descriptors + kDescriptorsAccepted; }, kClosingMax);
  const double megabytes = growth.most_megabytes - growth.warm_megabytes;
  const double megabytes_max =
      static_cast<double>(MemoryBound(static_cast<size_t>(plan.growth_mb * 1e6))) / 1e6;
  fmt::print(
      "after warming up: {:+.1f} MB at most; descriptors: {} before, {} after all have left\n"
      "{} jobs right, {} wrong; {} strangers, {} answered\n",
      megabytes, quiet_descriptors, descriptors(), record.finished(), record.failed(), flood.opened(),
      flood.answered());
  if (!workers.error().empty()) fmt::print("a worker failed: {}\n", workers.error());
  return record.failed() == 0 && record.finished() > 0 && flood.answered() == 0 && workers.error().empty() &&
         megabytes <= megabytes_max && is_closed;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::Plan plan;
  CLI::App app("a farm with clients that come and go and a flood of strangers");
  app.add_option("--minutes", plan.minutes, "to run")->check(CLI::Range(0.1, 1e4));
  app.add_option("--workers", plan.workers, "synthetic workers")->check(CLI::Range(1, 10'000));
  app.add_option("--clients", plan.clients, "that submit, fetch and leave")->check(CLI::Range(1, 1000));
  app.add_option("--flood", plan.flood, "connections of strangers that are open at the same time")
      ->check(CLI::Range(0, 10'000));
  app.add_option("--growth-mb", plan.growth_mb, "of memory that is accepted after warming up");
  CLI11_PARSE(app, argc, argv);
  try {
    return tessera::Soak(plan) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "soak: {}\n", error.what());
    return 1;
  }
}
