// A farm of real processes, each of which can be killed, stopped for a while and started again.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tests/end_to_end/process.h"

namespace tessera {

using Clock = std::chrono::steady_clock;

// All files are in one folder. The processes end with this object.
class ChaosFarm {
 public:
  // `data_dir` of the coordinator may lie on another file system.
  ChaosFarm(std::string folder, std::string data_dir, int workers);

  const std::string& address() const { return address_; }
  int workers() const { return static_cast<int>(workers_.size()); }

  // ---- Faults. Tick restarts or continues a process when its time has come.
  void KillWorker(int i, Clock::duration away);
  void StopWorker(int i, Clock::duration pause);
  void DrainWorker(int i, Clock::duration away);
  void KillCoordinator(Clock::duration away);
  void StopCoordinator(Clock::duration pause);
  bool IsHurt(int worker) const { return workers_[static_cast<size_t>(worker)].back_at.has_value(); }
  bool IsCoordinatorHurt() const { return coordinator_.back_at.has_value(); }
  // Restarts and continues the processes that are due. A process that ended by itself is recorded as a
  // failure and restarted.
  void Tick();
  // Restarts and continues all processes.
  void Heal();
  // Terminates all processes. Returns a message for each that does not end in time or with exit code 0.
  void End();

  // Whether there are so many failures that the run should be aborted.
  bool IsHopeless() const { return failures_.size() >= 5; }
  // Failures of the processes themselves.
  const std::vector<std::string>& failures() const { return failures_; }
  // The logs of all workers, also of those that have ended.
  std::vector<std::string> WorkerLogs() const;

 private:
  struct Member {
    std::optional<Process> process;
    std::optional<Clock::time_point> back_at;  // when it is restarted or continued
    bool is_stopped = false;
    bool is_draining = false;
  };
  void StartCoordinator();
  void StartWorker(size_t i);
  void Reap(Member& member, const std::string& name);
  void Return(Member& member, size_t i);

  std::string folder_, data_dir_;
  std::string address_ = "127.0.0.1:0";
  Member coordinator_;
  std::vector<Member> workers_;
  std::vector<std::string> logs_;  // of workers that have ended
  std::vector<std::string> failures_;
};

}  // namespace tessera
