#include "client/local_farm.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "proto/shell/console.h"
#include "proto/shell/program.h"
#include "proto/shell/system.h"
#include "proto/shell/values.h"
#include "proto/terms.h"
#include "renderer/text/unicode.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kStartPatience{30};  // for a loaded machine; an idle one takes about 30 ms
constexpr int kStartProbe_ms = 2;                   // between attempts to connect to the socket
// Workers that may fail a unit before the job fails; fewer if there are fewer workers.
constexpr int kAttemptsMax = 3;

// The folder of this program.
Result<std::string> ProgramFolder() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return Failed(fmt::format("/proc/self/exe: cannot be read: {}", error.message()));
  return program.parent_path().string();
}

// Where the workers note that they have passed the probe; empty if this user has no folder for that.
std::string ProbeFolder() {
  if (const std::string cache = Environment("XDG_CACHE_HOME"); !cache.empty())
    return cache + "/tessera-probe";
  if (const std::string home = Environment("HOME"); !home.empty()) return home + "/.cache/tessera-probe";
  return {};
}

bool HasEnded(const ChildProcess& process, int patience_ms) {
  pollfd event{process.ended_fd(), POLLIN, 0};
  return ::poll(&event, 1, patience_ms) > 0;
}

Error EndedError(const std::string& who, ChildProcess& process) {
  const std::string how = process.HowEnded();
  const std::string line = process.LastLine();
  return Failed(fmt::format("{} ended with {}{}{}", who, how, line.empty() ? "" : ": ", line));
}

}  // namespace

LocalFarm::LocalFarm(TemporaryFolder folder, std::string socket, ChildProcess coordinator,
                     Cancellation& cancellation)
    : folder_(std::move(folder)),
      socket_(std::move(socket)),
      address_("unix:" + socket_),
      coordinator_(std::move(coordinator)),
      cancellation_(cancellation),
      monitor_([this](Error why) { cancellation_.Cancel(std::move(why)); }) {}

// The members' destructors kill the processes: everything they hold is in the folder, which is removed too.
LocalFarm::~LocalFarm() {
  const uint64_t one = 1;
  if (closing_fd_ >= 0) TESSERA_CHECK(::write(closing_fd_, &one, sizeof one) == sizeof one);
  monitor_.Join();
  if (closing_fd_ >= 0) ::close(closing_fd_);
}

Result<std::unique_ptr<LocalFarm>> LocalFarm::Start(const LocalWorkers& workers, Cancellation& cancellation,
                                                    const std::string& kept) {
  const auto programs = ProgramFolder();
  if (!programs) return programs.error();
  auto folder = TemporaryFolder::Make();
  if (!folder) return folder.error();
  std::string socket = folder->path() + "/socket";
  auto coordinator = ChildProcess::Start(
      *programs + "/tessera-coordinator",
      {"--listen", "unix:" + socket, "--data-dir", (kept.empty() ? folder->path() : kept) + "/coordinator",
       "--sums-size", "0", "--attempts-max", std::to_string(std::min(workers.count, kAttemptsMax))},
      folder->path() + "/coordinator.log");
  if (!coordinator) return coordinator.error();
  std::unique_ptr<LocalFarm> farm(
      new LocalFarm(std::move(*folder), std::move(socket), std::move(*coordinator), cancellation));
  farm->closing_fd_ = ::eventfd(0, EFD_CLOEXEC);
  if (farm->closing_fd_ < 0) return SystemError("eventfd", "cannot be created");
  if (auto ready = farm->AwaitCoordinator(); !ready) return ready.error();
  if (auto started = farm->StartWorkers(*programs + "/tessera-worker", workers); !started) {
    return started.error();
  }
  if (auto started = farm->monitor_.Start([raw = farm.get()] { raw->Monitor(); }); !started)
    return started.error();
  return farm;
}

Result<void> LocalFarm::AwaitCoordinator() {
  const auto deadline = std::chrono::steady_clock::now() + kStartPatience;
  while (!CanConnect(socket_)) {
    if (cancellation_.cancelled()) return cancellation_.error();
    if (HasEnded(coordinator_, kStartProbe_ms)) return EndedError("tessera-coordinator", coordinator_);
    if (std::chrono::steady_clock::now() > deadline)
      return Failed(
          fmt::format("tessera-coordinator did not start listening within {} s", kStartPatience.count()));
  }
  return {};
}

Result<void> LocalFarm::StartWorkers(const std::string& program, const LocalWorkers& workers) {
  for (int i = 0; i < workers.count; ++i) {
    const std::string name = fmt::format("local-{}", i + 1);
    std::vector<std::string> words{
        "--coordinator",           address_, "--threads", std::to_string(workers.threads), "--cache-dir",
        folder_.path() + "/cache", "--name", name};
    if (const std::string probe = ProbeFolder(); !probe.empty())
      words.insert(words.end(), {"--probe-dir", probe});
    if (workers.scene_memory) words.insert(words.end(), {"--scene-memory", SizeText(*workers.scene_memory)});
    auto worker = ChildProcess::Start(program, words, fmt::format("{}/{}.log", folder_.path(), name));
    if (!worker) return worker.error();
    workers_.push_back(std::move(*worker));
  }
  return {};
}

void LocalFarm::Monitor() {
  std::vector<pollfd> events{{closing_fd_, POLLIN, 0}, {coordinator_.ended_fd(), POLLIN, 0}};
  for (const ChildProcess& worker : workers_) events.push_back({worker.ended_fd(), POLLIN, 0});
  size_t alive = workers_.size();
  while (true) {
    if (::poll(events.data(), events.size(), -1) < 0) continue;  // interrupted by a signal
    if (events[0].revents != 0) return;
    if (events[1].revents != 0) return cancellation_.Cancel(EndedError("tessera-coordinator", coordinator_));
    for (size_t i = 2; i < events.size(); ++i) {
      if (events[i].revents == 0) continue;
      const Error ended = EndedError(fmt::format("worker {}", i - 1), workers_[i - 2]);
      events[i] = {-1, 0, 0};  // ignored by poll
      if (--alive == 0)
        return cancellation_.Cancel(Failed(fmt::format("no worker is left: {}", ended.message)));
      PrintNote("\ntessera: warning: {}; the other workers continue\n",
                CleanText(ended.message, kReasonBytesMax));
    }
  }
}

}  // namespace tessera
