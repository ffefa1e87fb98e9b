// The machines of a simulation that run worker processes: the real workload of each worker, driven in
// simulated time. A process may die and start again, hang, or be cut off from the coordinator.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "tests/simulation/coordinator_process.h"
#include "tests/simulation/worker_model.h"
#include "tests/simulation/world.h"

namespace tessera {

class Machines {
 public:
  Machines(World& world, CoordinatorProcess& coordinator) : world_(world), coordinator_(coordinator) {}

  void Start();
  // One of the machines that were there at the start.
  size_t Some() { return static_cast<size_t>(world_.random.Int(0, world_.options.workers - 1)); }
  // The last call of the machine's worker that reached the coordinator.
  CallId LastCall(size_t machine) const { return machines_[machine].last_call; }

  // ---- Faults ----
  // The process is killed or says goodbye first; a new one starts later.
  void Die(size_t machine);
  // The process crashes, which the coordinator notices.
  void Crash(size_t machine);
  // The process is asked to end: it returns what waits, finishes what runs, and ends.
  void Drain(size_t machine);
  void HangUntil(size_t machine, Instant until) { machines_[machine].hung_until = until; }
  // What is sent to it or by it is lost.
  void CutOffUntil(size_t machine, Instant until, bool receives, bool sends);
  void AdvanceClock(size_t machine, Instant jump) { machines_[machine].clock += jump; }
  void KillAll();
  // The same, and the coordinator notices: all connections break.
  void CrashAll();
  // No machine hangs or is cut off any more, and sound ones join.
  void Heal(int sound_machines);

 private:
  struct Machine {
    double speed = 1;
    std::unique_ptr<WorkerModel> worker;
    uint64_t incarnation = 0;
    Instant hung_until{};
    Instant deaf_until{}, mute_until{};
    Instant clock{};            // ahead of simulated time
    CallId last_call{};         // the newest that reached the farm
    uint64_t sync_awaited = 0;  // sequence of the state whose answer it waits for
    uint64_t batches = 0;       // of results that were sent
    bool is_returning = false;  // waits for the answer to one
  };
  using Action = std::function<void(Machine&)>;

  Instant Now(size_t machine) const { return world_.queue.now() + machines_[machine].clock; }
  void SendToFarm(size_t machine, World::Deliver deliver);
  void SendToMachine(size_t machine, World::Deliver deliver);
  // Runs `action` on the process that runs there now, when it does not hang; never if it has died by then.
  void OnMachine(size_t machine, Instant delay, Action action);
  void StartWorker(size_t machine);
  void RestartLater(size_t machine);
  void AwaitDrained(size_t machine, Instant until);
  void Synchronize(size_t machine);
  void LoadScenes(size_t machine);
  void StartUnits(size_t machine);
  void FinishUnit(size_t machine, const UnitTask& task, double seconds);
  void SendBatch(size_t machine);
  // The answer to the batch that is on its way; an answer to an older one brings nothing new.
  void BatchAnswered(size_t machine, uint64_t batch, Action action);
  void SendResults(size_t machine, uint64_t batch, std::vector<FinishedUnit> results);
  void Prepare(size_t machine);
  void SendReport(size_t machine, uint64_t batch, const PreparationQueue::Report& report);
  void SendFailure(size_t machine, uint64_t batch, const FailureReport& failure);
  double CostOf(const WorkUnit& unit);

  World& world_;
  CoordinatorProcess& coordinator_;
  std::vector<Machine> machines_;
  uint64_t worker_next_ = 1;
};

}  // namespace tessera
