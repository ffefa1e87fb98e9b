// The real farm (scheduler, mergers, facts) with modelled workers under a modelled network, all in simulated
// time and all from one seed. Faults for a while, then healing, then every job must have ended as it should.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/farm.h"
#include "tests/simulation/event_queue.h"
#include "tests/simulation/picture_model.h"
#include "tests/simulation/random.h"
#include "tests/simulation/worker_model.h"
#include "util/digest.h"

namespace tessera {

// What may go wrong, and how much. Drawn per seed.
struct SimulationOptions {
  int workers = 2;
  int jobs = 1;
  double loss = 0;         // of a message, each way
  double duplication = 0;  // of a message, each way
  double delay_max_s = 0.001;
  double death_interval_s = 0;  // of some worker, on average; 0: never
  double hang_interval_s = 0;
  double crash_interval_s = 0;  // of the coordinator
  bool one_fails_units = false;
  bool one_damages_results = false;
  bool poison = false;  // one job has a unit that everybody fails
  bool cancel_one = false;
  double faults_s = 40;
};
SimulationOptions DrawOptions(uint64_t seed);

// What an observer saw, and what it holds against the farm.
struct SimulationReport {
  std::vector<std::string> violations;  // of invariants; empty if all held
  Digest trace;                         // of everything that happened
  double ended_s = 0;                   // when the last job ended
  uint64_t samples_rendered = 0, samples_needed = 0;
  int results = 0, refused = 0, duplicates = 0;
};

class Simulation {
 public:
  Simulation(uint64_t seed, SimulationOptions options);
  SimulationReport Run();

 private:
  struct Node {  // a machine: its worker process may die and start again
    std::unique_ptr<WorkerModel> worker;
    uint64_t incarnation = 0;
    Instant hung_until{};
    uint64_t sync_awaited = 0;  // number of the call whose answer it waits for
    CallId last_call{};         // the newest that reached the farm
    std::map<LeaseId, ReturnedUnit> unanswered;
  };
  struct JobModel {
    JobId id{};
    std::shared_ptr<const JobSpec> spec;
    double cost = 0;  // seconds per pixel sample
    bool poisoned = false;
    bool cancelled = false;
    std::set<uint32_t> pictures;  // frames that came out right
  };
  using Deliver = std::function<void()>;

  // simulation.cpp: the coordinator's side
  void StartFarm();
  void CrashFarm();
  void SubmitJobs();
  void Touch();  // the farm has events to apply
  void Step();
  void CheckPicture(const FinishedPicture& finished);
  bool AllEnded() const;
  void CheckEnd();
  void Violation(const std::string& what);
  void Trace(const std::string& line) { trace_.Add(line + "\n"); }
  std::string At() const { return std::to_string(queue_.now().count()); }

  // simulation_workers.cpp: the workers' side
  void Send(Deliver deliver);
  bool Healthy() const { return Seconds(queue_.now()) >= options_.faults_s; }
  void StartWorker(size_t node);
  void PlanFaults();
  void Die(size_t node);
  void Hang(size_t node);
  void Cut(CallId call);
  // Runs `action` on the process that runs there now, when it is not hung; never if it has died by then.
  void OnNode(size_t node, Instant delay, std::function<void(Node&)> action);
  void CallSynchronize(size_t node);
  void TakeDirective(size_t node, const WorkerDirective& directive);
  void StartUnits(size_t node);
  void FinishUnit(size_t node, const Lease& lease, double seconds);
  void CallReturnResults(size_t node, LeaseId lease);
  double CostOf(const WorkUnit& unit) const;
  const JobModel& ModelOf(JobId id) const;

  SimulationOptions options_;
  Random random_;
  EventQueue queue_;
  std::vector<Node> nodes_;
  std::vector<JobModel> jobs_;
  uint64_t worker_next_ = 1;

  std::unique_ptr<Farm> farm_;
  uint32_t epoch_ = 0;
  std::vector<std::string> journal_;  // facts, encoded: what survives a crash
  bool step_planned_ = false;
  uint64_t call_next_ = 1;
  std::map<CallId, std::function<void(const WorkerDirective&)>> directive_calls_;
  std::map<CallId, std::function<void(const FarmOutput::Results&)>> results_calls_;
  Sha256Stream trace_;
  SimulationReport report_;
};

}  // namespace tessera
