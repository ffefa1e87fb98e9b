// A large farm on one frame, in simulated time: the real farm (scheduler, merger) and the real workload of
// each worker, under slow machines and deaths. Measures what scheduling costs: the time of the whole against
// the time that the machines' speed allows, samples rendered in vain, and the coordinator's own time.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "coordinator/core/farm.h"
#include "tests/simulation/event_queue.h"
#include "tests/simulation/random.h"
#include "tests/simulation/worker_model.h"

namespace tessera {

struct ScaleOptions {
  uint64_t seed = 1;
  int workers = 10;  // of one slot each
  double slow_share = 0.1, slow_speed = 0.1;
  double deaths_per_minute = 0.05;  // of all workers
  double silent_share = 0.5;     // of the deaths: the coordinator does not notice, as when a cable is pulled
  double absence_s = 5;          // then the machine has a new process without any scene
  double load_s = 1;             // of the scene
  double latency_s = 0.001;      // each way
  double call_cost_s = 0.00005;  // of the coordinator's time, for each call and, besides, each result
  double result_cost_s = 0.0003;
  double ideal_s = 300;  // what the frame takes if all machines always work on it
  int width = 1920, height = 1080, tile_size = 64;
  uint32_t samples_per_pixel = 1024;
};
// A frame that is heavy enough for this many workers.
ScaleOptions ScaleOptionsFor(int workers, double ideal_s);

struct ScaleReport {
  bool finished = false;
  double ideal_s = 0;     // total work / total speed
  double makespan_s = 0;  // from the submission to the last sample merged
  // Shares of the total work:
  double lost_to_deaths = 0;  // samples that died with their worker
  double copied = 0;          // samples of units that another worker had finished before
  // Shares of what the machines could have done in the time:
  double absent = 0;
  uint64_t results = 0, calls = 0, leases = 0;
  double core_cpu_s = 0;

  double Ratio() const { return makespan_s / ideal_s; }
  double Waste() const { return lost_to_deaths + copied; }
};

class ScaleFarm {
 public:
  explicit ScaleFarm(ScaleOptions options);
  ScaleReport Run();

 private:
  struct Running {
    UnitTask task;
    Instant began{};
    double seconds = 0;
  };
  struct Machine {
    double speed = 1;
    std::unique_ptr<WorkerModel> worker;
    uint64_t incarnation = 0;
    std::optional<Running> running;
    bool returning = false;
    CallId last_call{};
    Instant died{};
  };
  using Event = std::function<void(Instant now)>;

  void Submit();
  double CostOf(const WorkUnit& unit) const;

  // ---- The coordinator: applies everything that arrived while it was busy in one batch
  void Post(Event event, double cost_s);
  void PlanStep(Instant at);
  void Step();

  // ---- Machines
  void Start(size_t machine);
  void PlanDeath(size_t machine);
  void Die(size_t machine);
  // Runs `action` after `delay` if the process that runs there now still does.
  void Later(size_t machine, Instant delay, std::function<void(Machine&)> action);
  void CallSynchronize(size_t machine);
  void LoadScenes(size_t machine);
  void StartUnit(size_t machine);
  void StopUnwanted(size_t machine);
  void FinishUnit(size_t machine);
  void ReturnResults(size_t machine);
  double CostDone(const Running& running) const;

  ScaleOptions options_;
  Random random_;
  EventQueue queue_;
  Farm farm_;
  JobId job_{};
  std::shared_ptr<const JobSpec> spec_;
  std::vector<double> tile_costs_;  // of one sample of all pixels
  double total_cost_ = 0, total_speed_ = 0;
  std::vector<Machine> machines_;
  uint64_t worker_next_ = 1, call_next_ = 1;

  std::vector<Event> events_;  // wait for the coordinator
  double events_cost_s_ = 0;
  Instant busy_until_{};
  uint64_t step_planned_ = 0;  // the number of the plan that holds
  Instant step_at_ = Instant::max();
  std::map<CallId, std::function<void(const WorkerDirective&)>> directive_calls_;
  std::map<CallId, std::function<void(const FarmOutput::Results&)>> results_calls_;

  double lost_ = 0, copied_ = 0, absent_ = 0;  // in cost
  ScaleReport report_;
};

}  // namespace tessera
