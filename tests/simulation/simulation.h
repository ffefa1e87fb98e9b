// The real farm (scheduler, mergers, facts) and the real workload of each worker, with a modelled network,
// disk and clocks, all in simulated time and all from one seed. Faults for a while, then healing, then every
// job must have ended as it should. Checkers watch from outside.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/farm.h"
#include "renderer/util/digest.h"
#include "tests/simulation/event_queue.h"
#include "tests/simulation/picture_model.h"
#include "tests/simulation/random.h"
#include "tests/simulation/result_ledger.h"
#include "tests/simulation/simulated_journal.h"
#include "tests/simulation/simulated_spool.h"
#include "tests/simulation/simulation_options.h"
#include "tests/simulation/worker_model.h"

namespace tessera {

// What an observer saw, and what it holds against the farm.
struct SimulationReport {
  std::vector<std::string> violations;  // of invariants; empty if all held
  Digest trace;                         // of everything that happened
  double ended_s = 0;                   // when the last job ended
  uint64_t samples_rendered = 0, samples_needed = 0;
  int results = 0, refused = 0, duplicates = 0, crashes = 0;
};

class Simulation {
 public:
  // `on_trace`, if any, is told everything that happens, line by line.
  using OnTrace = std::function<void(const std::string& line)>;
  Simulation(uint64_t seed, SimulationOptions options, OnTrace on_trace = {});
  SimulationReport Run();

 private:
  struct Node {  // a machine: its worker process may die and start again
    double speed = 1;
    std::unique_ptr<WorkerModel> worker;
    uint64_t incarnation = 0;
    Instant hung_until{};
    Instant deaf_until{}, mute_until{};  // what is sent to it, or by it, is lost
    Instant clock{};                     // ahead of simulated time
    CallId last_call{};                  // the newest that reached the farm
    uint64_t sync_awaited = 0;           // sequence of the state whose answer it waits for
    uint64_t parcels = 0;                // sent: counts them
    bool returning = false;              // waits for the answer to one
  };
  struct JobModel {
    JobId id{};  // as the farm last journalled it
    std::shared_ptr<const JobSpec> spec;
    std::vector<Merger> reference;       // of each frame
    std::vector<FramePicture> pictures;  // of the reference
    double cost = 0;                     // seconds per pixel sample
    bool poisoned = false;
    bool acknowledged = false;           // the client knows that the farm has it
    bool cancelled = false;              // the client asked for it
    JobState told = JobState::kWaiting;  // the last that anybody was told
  };
  struct ResultsCall {
    std::vector<WorkUnit> units;
    std::function<void(const FarmOutput::Results&)> answer;
  };
  using Deliver = std::function<void()>;

  // simulation.cpp: the coordinator's side
  void StartFarm();
  void RestoreSpool();
  void CrashFarm();
  void Touch();  // the farm has events to apply
  void Step();
  void PlanStep(Instant delay);
  Result<void> Sync();
  void Answer(FarmOutput output);
  void WritePicture(JobId job, uint32_t frame);
  Instant FarmNow() const { return queue_.now() + farm_clock_; }
  void Trace(const std::string& line);

  // simulation_checks.cpp: clients, and what they and an observer hold against the farm
  void MakeJobs();
  void Submit(size_t job);
  void Cancel(size_t job);
  JobModel* SomeOpenJob();
  void WishPause();
  void WishPriority();
  void ResumeAll();
  JobModel* ModelOf(JobId id);
  void NoteFact(const Fact& fact);
  FrameSpec DrawFrame();
  void CheckGrants(const FarmOutput& output);
  void CheckGrant(const Lease& lease);
  void CheckPicture(const FinishedPicture& finished);
  void CheckMemory();
  bool AllEnded();
  void CheckEnd();
  void Violation(const std::string& what);

  // simulation_workers.cpp: the workers' side
  void SendToFarm(size_t node, Deliver deliver);
  void SendToNode(size_t node, Deliver deliver);
  void Send(Deliver deliver);
  Instant NodeNow(size_t node) const { return queue_.now() + nodes_[node].clock; }
  void StartWorker(size_t node);
  // Runs `action` on the process that runs there now, when it is not hung; never if it has died by then.
  void OnNode(size_t node, Instant delay, std::function<void(Node&)> action);
  void CallSynchronize(size_t node);
  void LoadScenes(size_t node);
  void StartUnits(size_t node);
  void FinishUnit(size_t node, const UnitTask& task, double seconds);
  void SendParcel(size_t node);
  void ParcelAnswered(size_t node, uint64_t parcel, std::function<void(Node&)> action);
  void SendResults(size_t node, uint64_t parcel, std::vector<FinishedUnit> results);
  void SendFailure(size_t node, uint64_t parcel, const FailureReport& failure);
  double CostOf(const WorkUnit& unit);

  // simulation_faults.cpp
  bool Healthy() const { return Seconds(queue_.now()) >= options_.faults_s; }
  void Repeat(double interval_s, std::function<void()> fault);
  void PlanFaults();
  void Heal();
  size_t SomeNode() { return static_cast<size_t>(random_.Int(0, options_.workers - 1)); }
  void Die(size_t node);
  void Drain(size_t node);
  void AwaitDrained(size_t node, Instant until);
  void Hang(size_t node);
  void Partition(size_t node);
  void JumpClock();
  void FillDisk();
  void SetDiskFull(bool full);
  void Blackout();
  void Cut(CallId call);

  SimulationOptions options_;
  OnTrace on_trace_;
  Random random_;
  EventQueue queue_;
  std::vector<Node> nodes_;
  std::vector<JobModel> jobs_;
  uint64_t worker_next_ = 1;

  std::unique_ptr<Farm> farm_;
  SimulatedJournal journal_;
  SimulatedSpool spool_;
  bool disk_full_ = false;
  Instant farm_clock_{};  // ahead of simulated time; each process has its own
  // 1: crash before the next sync, 2: between spool and journal, 3: after it, before the answers.
  int crash_point_ = 0;
  uint64_t step_planned_ = 0;
  Instant step_at_ = Instant::max();
  uint64_t call_next_ = 1;
  std::vector<FarmOutput> unsynced_;
  std::map<CallId, std::function<void(const WorkerDirective&)>> directive_calls_;
  std::map<CallId, ResultsCall> results_calls_;
  std::vector<Deliver> after_sync_;

  ResultLedger ledger_;
  Sha256Stream trace_;
  SimulationReport report_;
};

}  // namespace tessera
