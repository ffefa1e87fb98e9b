#include "tests/chaos/chaos_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <thread>

#include "tests/chaos/acknowledged.h"
#include "tests/chaos/chaos_farm.h"
#include "tests/chaos/customer.h"
#include "tests/chaos/damage.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using std::chrono::duration_cast;

constexpr size_t kCustomers = 2;
constexpr std::chrono::milliseconds kTick{20};
constexpr const char* kSmallDiskOptions = "size=24m";  // less than the pictures and spools of all jobs

// Makes the mounts of this process private to it and its children. Without permission to mount, becomes root
// in a namespace if the system allows it. Must be called before any thread is started.
bool MakeMountsPrivate() {
  const uid_t user = ::getuid();
  const gid_t group = ::getgid();
  if (::unshare(CLONE_NEWNS) != 0) {
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << fmt::format("0 {} 1", user);
    std::ofstream("/proc/self/gid_map") << fmt::format("0 {} 1", group);
  }
  return ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
}

// A folder under /tmp that is removed with its contents.
class ChaosFolder {
 public:
  explicit ChaosFolder(bool small_disk) {
    std::string path = "/tmp/tessera-chaos-XXXXXX";
    if (::mkdtemp(path.data()) == nullptr) throw std::runtime_error("cannot create a folder in /tmp");
    path_ = path;
    fs::create_directories(path_ + "/tmp");
    fs::create_directories(data());
    if (!small_disk) return;
    is_mounted_ =
        MakeMountsPrivate() && ::mount("tessera-chaos", data().c_str(), "tmpfs", 0, kSmallDiskOptions) == 0;
    if (!is_mounted_) mount_error_ = std::strerror(errno);
  }
  ~ChaosFolder() {
    if (is_mounted_) ::umount2(data().c_str(), MNT_DETACH);
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ChaosFolder(const ChaosFolder&) = delete;
  ChaosFolder& operator=(const ChaosFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string data() const { return path_ + "/disk"; }
  const std::string& mount_error() const { return mount_error_; }

 private:
  std::string path_, mount_error_;
  bool is_mounted_ = false;
};

// Uses up all space of a file system for a while.
class DiskFiller {
 public:
  explicit DiskFiller(std::string folder) : path_(std::move(folder) + "/filler") {}
  bool is_full() const { return until_ != Clock::time_point(); }
  void Fill(Clock::duration duration) {
    until_ = Clock::now() + duration;
    const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const std::string block(size_t{1} << 16, 'x');
    for (size_t size = block.size(); size > 0;) {  // smaller blocks for the remaining space
      if (::write(file, block.data(), size) <= 0) size /= 2;
    }
    ::close(file);
  }
  void Tick() {
    if (is_full() && Clock::now() >= until_) Empty();
  }
  void Empty() {
    std::error_code ignored;
    fs::remove(path_, ignored);
    until_ = {};
  }

 private:
  std::string path_;
  Clock::time_point until_;
};

// Draws faults and injects them.
class Adversary {
 public:
  Adversary(const ChaosOptions& options, const ChaosFolder& folder, ChaosFarm& farm, DiskFiller& filler,
            ChaosReport& report)
      : options_(options),
        folder_(folder),
        farm_(farm),
        filler_(filler),
        report_(report),
        random_(options.seed) {}

  void Strike() {
    const int kind = Below(100);
    if (options_.small_disk && kind < 10 && !filler_.is_full()) {
      filler_.Fill(Between(500, 4000));
      ++report_.disk_fills;
    } else if (kind < 20 && HurtsCoordinator() && !farm_.IsCoordinatorHurt()) {
      HurtCoordinator();
    } else {
      const int worker = Below(farm_.workers());
      if (!farm_.IsHurt(worker)) HurtWorker(worker);
    }
  }
  Clock::duration Pause() { return Between(50, 400); }
  bool IsDone() const {
    return report_.worker_kills + report_.worker_stops + report_.worker_drains >= options_.worker_faults &&
           report_.coordinator_kills >= options_.coordinator_faults;
  }

 private:
  bool HurtsCoordinator() const {
    return options_.coordinator_faults > 0 &&
           (options_.seconds > 0 || report_.coordinator_kills < options_.coordinator_faults);
  }
  void HurtCoordinator() {
    if (Below(4) == 0) {
      farm_.StopCoordinator(Between(100, 2000));
      ++report_.coordinator_stops;
    } else {
      farm_.KillCoordinator(Between(0, 2000));
      ++report_.coordinator_kills;
      if (Below(2) == 0) Damage(folder_.data() + (Below(2) == 0 ? "/pictures" : "/blobs"));
    }
  }
  // Only while the process that owns the files is away, as it may be writing them.
  void Damage(const std::string& folder) {
    if (FlipBit(folder, random_)) ++report_.bit_flips;
  }
  void HurtWorker(int worker) {
    const int kind = Below(10);
    if (kind < 5) {
      farm_.KillWorker(worker, Between(0, 2000));
      ++report_.worker_kills;
      if (Below(2) == 0) Damage(fmt::format("{}/cache-w{}", folder_.path(), worker));
    } else if (kind < 9) {
      const bool is_given_up = Below(8) == 0;  // longer than the coordinator waits for a worker
      farm_.StopWorker(worker, is_given_up ? Between(11'000, 13'000) : Between(50, 3000));
      ++report_.worker_stops;
    } else {
      farm_.DrainWorker(worker, Between(500, 2000));
      ++report_.worker_drains;
    }
  }
  int Below(int limit) { return std::uniform_int_distribution<int>(0, limit - 1)(random_); }
  Clock::duration Between(int from_ms, int to_ms) {
    return std::chrono::milliseconds(std::uniform_int_distribution<int>(from_ms, to_ms)(random_));
  }

  const ChaosOptions& options_;
  const ChaosFolder& folder_;
  ChaosFarm& farm_;
  DiskFiller& filler_;
  ChaosReport& report_;
  std::mt19937_64 random_;
};

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
  for (const pid_t child : ChildrenOf(::getpid())) {
    problems.push_back(fmt::format("process {} was left behind", child));
  }
}

// The store contains the files of the jobs and nothing else.
void LookForBlobs(const ChaosFolder& folder, const std::vector<ChaosJob>& jobs,
                  std::vector<std::string>& problems) {
  std::string expected;
  for (const ChaosJob& job : jobs) {
    std::vector<std::string> words{"info", job.scene, "--json"};
    words.insert(words.end(), job.options.begin(), job.options.end());
    expected += RunProgram(folder.path(), "tessera", words).output;
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder.data() + "/blobs")) {
    if (!entry.is_regular_file()) continue;
    const std::string name = entry.path().filename().string();
    if (expected.find(name) == std::string::npos)
      problems.push_back("blob " + name + " does not belong to any job");
  }
}

void Count(const ChaosFarm& farm, ChaosReport& report) {
  std::vector<Acknowledgement> all;
  for (const std::string& log : farm.WorkerLogs()) {
    for (Acknowledgement& each : ReadAcknowledgements(log)) all.push_back(std::move(each));
  }
  report.acknowledged = all.size();
  const auto again = RenderedAgain(std::move(all));
  report.rendered_again = again.size();
  for (const Acknowledgement& each : again) {
    report.problems.push_back(fmt::format(
        "rendered again although acknowledged: job {} frame {} tile {} samples [{},{}), {}", each.job,
        each.frame, each.tile, each.range.begin, each.range.begin + each.range.size, each.time));
  }
}

void Run(const ChaosOptions& options, const ChaosFolder& folder, ChaosReport& report) {
  const std::vector<ChaosJob> jobs = PrepareJobs(folder.path(), options.samples_per_pixel);
  ChaosFarm farm(folder.path(), folder.data(), options.workers);
  Customers customers(folder.path(), farm.address(), jobs);
  std::atomic<size_t> working = kCustomers;
  std::vector<std::thread> threads;
  for (size_t i = 0; i < kCustomers; ++i) {
    threads.emplace_back([&, i] {
      customers.Work(i);
      --working;
    });
  }
  DiskFiller filler(folder.data());
  Adversary adversary(options, folder, farm, filler, report);
  const auto end =
      Clock::now() + duration_cast<Clock::duration>(std::chrono::duration<double>(options.seconds));
  auto next = Clock::now() + adversary.Pause();
  while ((Clock::now() < end || !adversary.IsDone()) && working == kCustomers && !farm.IsHopeless()) {
    std::this_thread::sleep_for(kTick);
    farm.Tick();
    filler.Tick();
    if (Clock::now() < next) continue;
    adversary.Strike();
    next = Clock::now() + adversary.Pause();
  }
  customers.Close();
  filler.Empty();
  farm.Heal();
  while (working > 0 && !farm.IsHopeless()) {
    std::this_thread::sleep_for(kTick);
    farm.Tick();
  }
  if (farm.IsHopeless()) customers.GiveUp();
  for (std::thread& thread : threads) thread.join();
  farm.End();
  report.pictures = customers.pictures();
  report.problems = customers.problems();
  report.problems.insert(report.problems.end(), farm.failures().begin(), farm.failures().end());
  Count(farm, report);
  LookForProcesses(report.problems);
  LookForTemporaryFiles(folder.path(), report.problems);
  LookForBlobs(folder, jobs, report.problems);
}

}  // namespace

std::string ChaosReport::Text() const {
  if (!skipped.empty()) return "skipped: " + skipped;
  std::string text = fmt::format(
      "workers: {} kills, {} stops, {} drains; coordinator: {} kills, {} stops; disk full {} times; {} bits "
      "flipped\n"
      "{} pictures compared; {} results acknowledged, {} of them rendered again\n",
      worker_kills, worker_stops, worker_drains, coordinator_kills, coordinator_stops, disk_fills, bit_flips,
      pictures, acknowledged, rendered_again);
  for (const std::string& problem : problems) text += "PROBLEM: " + problem + "\n";
  return text + (Passed() ? "passed" : fmt::format("{} problems", problems.size()));
}

ChaosReport RunChaos(const ChaosOptions& options) {
  ChaosReport report;
  const ChaosFolder folder(options.small_disk);
  if (!folder.mount_error().empty()) {
    report.skipped = "cannot mount a small file system: " + folder.mount_error();
    return report;
  }
  Run(options, folder, report);
  return report;
}

}  // namespace tessera
