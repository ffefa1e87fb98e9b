// Two farms of real processes, each with a data directory, an address and workers that know this address.
// Each process can be killed, stopped for a while and started again, and the farms can exchange their
// addresses and be restored to an earlier state.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tests/chaos/farm_history.h"
#include "tests/chaos/lasting_fault.h"
#include "tests/end_to_end/process.h"

namespace tessera {

// Few for each process, so that connections exhaust them.
constexpr int kCoordinatorDescriptors = 256, kWorkerDescriptors = 128;

// All files are in one folder. The processes end with this object.
class ChaosFarms {
 public:
  // The data directories are in `disk`. Coordinators start through `prefix`: words of a command line that
  // runs the rest of it.
  ChaosFarms(std::string folder, std::string disk, int workers, std::vector<std::string> prefix,
             FarmHistory& history);

  std::string DataDir(int farm) const;
  int workers() const { return static_cast<int>(workers_.size()); }

  // ---- Faults. Tick restarts or continues a process when its time has come.
  void KillWorker(int i, Clock::duration away);
  void StopWorker(int i, Clock::duration pause);
  void DrainWorker(int i, Clock::duration away);
  void KillCoordinator(int farm, Clock::duration away);
  void StopCoordinator(int farm, Clock::duration pause);
  // Each farm goes to the address of the other, where it meets the other's workers. No coordinator may be
  // hurt.
  void ExchangeAddresses();
  // Saves the state of a farm whose coordinator is not hurt. It is down meanwhile.
  void BackUp(int farm);
  // Returns a farm whose coordinator is not hurt to its last backup. Returns false if there is none.
  bool Restore(int farm);
  bool IsHurt(int worker) const { return workers_[static_cast<size_t>(worker)].back_at.has_value(); }
  bool IsCoordinatorHurt(int farm) const { return At(farm).coordinator.back_at.has_value(); }
  // Counts what has happened to the coordinator of a farm: whether it was away since an earlier call.
  int CoordinatorFaults(int farm) const { return At(farm).faults; }

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
  // The logs of all workers and of all coordinators, also of those that have ended.
  std::vector<std::string> WorkerLogs() const;
  std::vector<std::string> CoordinatorLogs() const;
  // The times at which a farm was restored, as in logs.
  struct RestoredFarm {
    std::string farm;  // its identity
    std::string time;
  };
  const std::vector<RestoredFarm>& restores() const { return restores_; }

 private:
  struct Member {
    std::optional<Process> process;
    std::optional<Clock::time_point> back_at;  // when it is restarted or continued
    bool is_stopped = false;
    bool is_draining = false;
  };
  struct Farm {
    Member coordinator;
    size_t address = 0;  // index
    std::string id;
    int faults = 0;
  };
  Farm& At(int farm) { return farms_.at(static_cast<size_t>(farm)); }
  const Farm& At(int farm) const { return farms_.at(static_cast<size_t>(farm)); }
  std::string BackupDir(int farm) const;
  void StartCoordinator(int farm);
  void StartWorker(size_t i);
  void LearnIds();
  void Reap(Member& member, const std::string& name, std::vector<std::string>& logs);
  void ReapCoordinator(int farm);
  void ReapWorker(size_t i);
  void ReturnCoordinator(int farm);
  void ReturnWorker(size_t i);

  const std::string folder_, disk_;
  const std::vector<std::string> prefix_;
  FarmHistory& history_;
  std::array<std::string, kFarms> addresses_;
  std::array<Farm, kFarms> farms_;
  std::vector<Member> workers_;
  std::vector<std::string> worker_logs_, coordinator_logs_;  // of those that have ended
  std::vector<std::string> failures_;
  std::vector<RestoredFarm> restores_;
};

}  // namespace tessera
