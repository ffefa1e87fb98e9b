#include "tests/chaos/chaos_run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <optional>
#include <thread>

#include "tests/chaos/acknowledged.h"
#include "tests/chaos/faults.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using std::chrono::duration_cast;

constexpr std::chrono::milliseconds kTick{20};
// Some 120 MB more than a worker has with all scenes of the customers.
constexpr uint64_t kWorkerBytesMax = uint64_t{320} << 20;
// Of the deadly scene: a worker reaches its limit well before it has loaded it.
constexpr uint64_t kDeadlySceneBytes = uint64_t{512} << 20;
// What coordinators log when they meet the faults of a run.
constexpr const char* kNoticed[] = {"connections_refused", "picture_damaged", "spool_file_ignored",
                                    "torn_tail_removed", "worker_lost"};

// Temporary files and processes that were not removed.
void LookForTemporaryFiles(const std::string& folder, std::vector<std::string>& problems) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_temporary = name.find(".tmp") != std::string::npos;
    const bool is_in_tmp = entry.path().parent_path() == folder + "/tmp";
    if (is_temporary || is_in_tmp) problems.push_back(entry.path().string() + " was left behind");
  }
}

void LookForProcesses(std::vector<std::string>& problems) {
  for (const pid_t child : ChildrenOf(::getpid()))
    problems.push_back(fmt::format("process {} was left behind", child));
}

// The stores contain the files of the jobs and nothing else but what stalled clients may go on with.
void LookForBlobs(const ChaosFolder& folder, const ChaosFarms& farms, const std::vector<ChaosJob>& jobs,
                  std::vector<std::string>& problems) {
  std::string expected = StalledClients::Files();
  for (const ChaosJob& job : jobs) {
    std::vector<std::string> words{"info", job.scene, "--json"};
    words.insert(words.end(), job.options.begin(), job.options.end());
    expected += RunProgram(folder.path(), "tessera", words).output;
  }
  for (int farm = 0; farm < kFarms; ++farm) {
    for (const auto& entry : fs::recursive_directory_iterator(farms.DataDir(farm) + "/blobs")) {
      if (!entry.is_regular_file()) continue;
      if (expected.find(entry.path().filename().string()) == std::string::npos)
        problems.push_back(entry.path().string() + " was left behind");
    }
  }
}

void CountAcknowledged(const ChaosFarms& farms, ChaosReport& report) {
  std::vector<Acknowledgement> all;
  for (const std::string& log : farms.WorkerLogs()) {
    for (Acknowledgement& each : ReadAcknowledgements(log)) all.push_back(std::move(each));
  }
  for (Acknowledgement& each : all) {
    for (const auto& restore : farms.restores())
      each.restores += restore.farm == each.farm && each.time > restore.time ? 1 : 0;
  }
  report.acknowledged = all.size();
  if (all.empty() && report.pictures > 0)
    report.problems.push_back("no acknowledged result was found in the logs of the workers");
  const auto again = RenderedAgain(std::move(all));
  report.rendered_again = again.size();
  for (const Acknowledgement& each : again) {
    report.problems.push_back(fmt::format(
        "rendered again although acknowledged: farm {} job {} frame {} tile {} samples [{},{}), {}",
        each.farm, each.job, each.frame, each.tile, each.range.begin, each.range.begin + each.range.size,
        each.time));
  }
}

std::string Noticed(const ChaosFarms& farms) {
  std::string text;
  for (const char* event : kNoticed) {
    size_t count = 0;
    for (const std::string& log : farms.CoordinatorLogs()) {
      for (size_t at = log.find(event); at != std::string::npos; at = log.find(event, at + 1)) ++count;
    }
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", event, count);
  }
  return text;
}

// Customers and faults of a run.
class Run {
 public:
  Run(const ChaosOptions& options, const ChaosFolder& folder, std::vector<size_t> kinds)
      : options_(options),
        folder_(folder),
        jobs_(PrepareJobs(folder.path(), options.samples_per_pixel)),
        deadly_(PrepareDeadlyJob(folder.path(), kDeadlySceneBytes)),
        slow_disk_(folder.path()),
        farms_(folder.path(), folder.disk(), options.workers, slow_disk_.Prefix(), history_),
        memory_(SlowDisk::Library().empty() ? UINT64_MAX : kWorkerBytesMax),
        customers_(folder.path(), history_, jobs_, deadly_),
        filler_(folder.disk()),
        probes_(folder.path(), farms_, history_),
        dice_(options.seed),
        adversary_(std::move(kinds), options.each,
                   {folder, farms_, history_, customers_, filler_, slow_disk_, connections_, stalled_,
                    probes_, dice_}) {}

  void Perform(ChaosReport& report) {
    StartCustomers();
    InjectFaults();
    Heal();
    if (farms_.IsHopeless()) customers_.GiveUp();
    for (std::thread& thread : threads_) thread.join();
    for (LastingFault* fault : lasting()) fault->End();
    farms_.End();
    Write(report);
  }

 private:
  std::vector<LastingFault*> lasting() {
    std::vector<LastingFault*> all{&filler_, &slow_disk_, &stalled_};
    for (SilentConnections& each : connections_) all.push_back(&each);
    return all;
  }

  void StartCustomers() {
    for (size_t i = 0; i < Customers::kCustomers; ++i) {
      threads_.emplace_back([this, i] {
        customers_.Work(i);
        --working_;
      });
    }
    threads_.emplace_back([this] {
      customers_.WorkOnDeadlyJobs();
      --working_;
    });
  }

  void Tick() {
    std::this_thread::sleep_for(kTick);
    farms_.Tick();
    std::array<bool, kFarms> were_open{};
    for (size_t i = 0; i < kFarms; ++i) were_open[i] = connections_[i].is_open();
    for (LastingFault* fault : lasting()) fault->Tick();
    for (size_t i = 0; i < kFarms; ++i) {
      if (were_open[i] && !connections_[i].is_open() && !farms_.IsCoordinatorHurt(static_cast<int>(i)))
        probes_.Ask(static_cast<int>(i), "after its descriptors were free again");
    }
    probes_.Tick();
  }

  // While a scene kills workers nothing else does, so that they are lost alone, one after the other.
  void InjectFaults() {
    const auto end =
        Clock::now() + duration_cast<Clock::duration>(std::chrono::duration<double>(options_.seconds));
    auto next = Clock::now() + dice_.Between(options_.pause_ms / 5, options_.pause_ms * 9 / 5);
    while ((Clock::now() < end || !adversary_.IsDone()) && working_ == kThreads && !farms_.IsHopeless()) {
      Tick();
      if (Clock::now() < next || customers_.is_deadly_job_open()) continue;
      adversary_.Strike();
      next = Clock::now() + dice_.Between(options_.pause_ms / 5, options_.pause_ms * 9 / 5);
    }
  }

  void Heal() {
    customers_.Close();
    for (LastingFault* fault : lasting()) {
      if (fault != &stalled_) fault->End();
    }
    farms_.Heal();
    while (working_ > 0 && !farms_.IsHopeless()) Tick();
  }

  void Write(ChaosReport& report) {
    report.faults = adversary_.Text();
    report.pictures = customers_.pictures();
    report.pictures_again = customers_.pictures_again();
    report.jobs_lost = customers_.jobs_lost();
    report.deadly_jobs = customers_.deadly_jobs_failed();
    report.memory_kills = memory_.kills();
    report.stalls = stalled_.checked();
    report.probes = probes_.answered();
    report.noticed = Noticed(farms_);
    const auto add = [&](const std::vector<std::string>& problems) {
      report.problems.insert(report.problems.end(), problems.begin(), problems.end());
    };
    add(customers_.problems());
    add(farms_.failures());
    add(probes_.problems());
    for (const LastingFault* fault : lasting()) add(fault->problems());
    CountAcknowledged(farms_, report);
    LookForProcesses(report.problems);
    LookForTemporaryFiles(folder_.path(), report.problems);
    std::vector<ChaosJob> all = jobs_;
    all.push_back(deadly_);
    LookForBlobs(folder_, farms_, all, report.problems);
  }

  static constexpr size_t kThreads = Customers::kCustomers + 1;

  const ChaosOptions& options_;
  const ChaosFolder& folder_;
  const std::vector<ChaosJob> jobs_;
  const ChaosJob deadly_;
  FarmHistory history_;
  SlowDisk slow_disk_;
  ChaosFarms farms_;
  MemoryLimit memory_;
  Customers customers_;
  DiskFiller filler_;
  std::array<SilentConnections, kFarms> connections_;
  StalledClients stalled_;
  Probes probes_;
  Dice dice_;
  Adversary adversary_;
  std::atomic<size_t> working_ = kThreads;
  std::vector<std::thread> threads_;
};

}  // namespace

std::string ChaosReport::Text() const {
  if (!skipped.empty()) return "skipped: " + skipped;
  std::string text = fmt::format(
      "faults: {}\ncoordinators logged: {}\n"
      "{} pictures compared, {} of them again at the end; {} jobs lost by restores; {} deadly jobs failed, "
      "{} "
      "workers killed for their memory; {} stalled calls ended; {} probes answered\n"
      "{} results acknowledged, {} of them rendered again\n",
      faults, noticed, pictures, pictures_again, jobs_lost, deadly_jobs, memory_kills, stalls, probes,
      acknowledged, rendered_again);
  for (const std::string& problem : problems) text += "PROBLEM: " + problem + "\n";
  return text + (Passed() ? "passed" : fmt::format("{} problems", problems.size()));
}

ChaosReport RunChaos(const ChaosOptions& options) {
  ChaosReport report;
  auto kinds = FindFaults(options.faults, options.small_disk);
  if (!kinds) {
    report.problems.push_back(kinds.error().message);
    return report;
  }
  const ChaosFolder folder(options.small_disk);
  if (!folder.mount_error().empty()) {
    report.skipped = "cannot mount a small file system: " + folder.mount_error();
    return report;
  }
  Run(options, folder, std::move(*kinds)).Perform(report);
  return report;
}

}  // namespace tessera
