// A farm of real processes that can be hurt: each can be killed, stopped for a while and started again.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tests/end_to_end/process.h"

namespace tessera {

using Clock = std::chrono::steady_clock;

// Everything lives in one folder; the processes end with this object.
class ChaosFarm {
 public:
  // `data_dir` of the coordinator may lie on another file system.
  ChaosFarm(std::string folder, std::string data_dir, int workers);

  const std::string& address() const { return address_; }
  int workers() const { return static_cast<int>(workers_.size()); }

  // ---- Faults. A process that is away comes back by Tick, when its time has come.
  void KillWorker(int i, Clock::duration away);
  void StopWorker(int i, Clock::duration pause);
  void DrainWorker(int i, Clock::duration away);
  void KillCoordinator(Clock::duration away);
  void StopCoordinator(Clock::duration pause);
  bool IsHurt(int worker) const { return workers_[static_cast<size_t>(worker)].back_at.has_value(); }
  bool IsCoordinatorHurt() const { return coordinator_.back_at.has_value(); }
  // Starts again and continues what is due. What ended by itself is remembered as a failure, and started
  // again.
  void Tick();
  // All come back at once.
  void Heal();
  // Asks all to end; a message for each that does not, within the time that is promised, or not well.
  void End();

  // Whether so much went wrong that there is no use in going on.
  bool IsHopeless() const { return failures_.size() >= 5; }
  // What went wrong with the processes themselves.
  const std::vector<std::string>& failures() const { return failures_; }
  // What all workers there ever were have logged.
  std::vector<std::string> WorkerLogs() const;

 private:
  struct Member {
    std::optional<Process> process;
    std::optional<Clock::time_point> back_at;  // when it is started or continued
    bool is_stopped = false;
    bool is_draining = false;
  };
  void StartCoordinator();
  void StartWorker(size_t i);
  void Bury(Member& member, const std::string& name);
  void Return(Member& member, size_t i);

  std::string folder_, data_dir_;
  std::string address_ = "127.0.0.1:0";
  Member coordinator_;
  std::vector<Member> workers_;
  std::vector<std::string> logs_;  // of workers that have gone
  std::vector<std::string> failures_;
};

}  // namespace tessera
