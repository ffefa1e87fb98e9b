// Everything a worker has to do and has done: leases, scenes, and results on their way to the coordinator. A
// pure state machine: time is passed in, and waiting is left to the shell (worker/shared_workload.h).
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "proto/failure_cause.h"
#include "proto/terms.h"
#include "worker/core/held_leases.h"
#include "worker/core/preparation_queue.h"
#include "worker/core/scene_table.h"

namespace tessera {

// A rendered unit, encoded for sending.
struct FinishedUnit {
  LeaseId lease{};
  WorkUnit unit;
  std::string tile;  // EncodeRadianceTile
  double render_seconds = 0;
  FarmId farm{};  // set by the workload
};

// A unit that could not be rendered or, without a lease, a scene that could not be loaded.
struct FailureReport {
  LeaseId lease{};
  WorkUnit unit;
  Digest scene;
  std::string reason;
  FailureCause cause = FailureCause::kScene;  // if there is no lease
  FarmId farm{};
  uint64_t number = 0;  // counts the reports of this process
};

// A unit to render and everything it needs.
struct UnitTask {
  Lease lease;
  SceneTable::ScenePointer scene;
  HeldLeases::StopFlag stop;
};

// Not thread safe.
class Workload {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  // ---- From the coordinator
  void Apply(const WorkerDirective& directive, TimePoint now);
  // The same for the answer to a state that a later one has overtaken: its scenes are out of date.
  void ApplyOvertaken(const WorkerDirective& directive, TimePoint now);
  // Leases that came with the answer to results or a failure. Does nothing if they are of another farm: only
  // the exchange of states decides to which farm this worker belongs.
  void AddLeases(FarmId farm, const std::vector<Lease>& leases, const std::vector<LeaseId>& drop,
                 TimePoint now);
  // Fills in what the coordinator is told: farm, scenes, leases, returned leases and whether the worker
  // drains. The wait is short enough to keep the leases.
  void FillState(WorkerState& state, TimePoint now) const;
  // The coordinator has answered a state that listed these leases as returned.
  void ReturnsAcknowledged(const std::vector<LeaseId>& returned);

  // ---- Units
  // The next unit that can be rendered, which counts as running from now on.
  std::optional<UnitTask> StartUnit(TimePoint now);
  // Returns false if it was dropped meanwhile, so its result is not wanted.
  bool UnitFinished(FinishedUnit unit, TimePoint now);
  void UnitFailed(const Lease& lease, std::string reason);
  // Rendering was stopped because the unit is not wanted.
  void UnitStopped(LeaseId lease) { leases_.Forget(lease); }

  // ---- Scenes
  // The next scene to load, which counts as loading from now on; nullopt while draining.
  std::optional<SceneRequest> StartScene(TimePoint now);
  // When StartScene may return a scene that failed before, if nothing else changes.
  std::optional<TimePoint> NextRetry() const { return draining_ ? std::nullopt : scenes_.NextRetry(); }
  void SceneLoaded(const Digest& key, SceneTable::ScenePointer scene);
  void SceneFailed(const Digest& key, std::string reason, FailureCause cause, TimePoint now);

  // ---- Preparations
  // The next scene to prepare; nullopt while draining.
  std::optional<PreparationRequest> StartPreparation();
  void PreparationFinished(PreparationReport report);

  // ---- Results, failures and reports of preparations
  bool HasBatch() const {
    return !failures_.empty() || !results_.empty() || preparations_.NextReport() != nullptr;
  }
  // The next report or failure, or the next results: the first and up to `bytes_max` bytes more. They stay
  // here until they are acknowledged.
  using Batch =
      std::variant<std::monostate, FailureReport, std::vector<FinishedUnit>, PreparationQueue::Report>;
  Batch NextBatch(size_t bytes_max) const;
  // This failure, this report or these results have been acknowledged.
  void PreparationAnswered(const PreparationReport& report);
  void PreparationRefused(const PreparationReport& report, const std::string& reason) {
    preparations_.Refuse(report.key, reason);
  }
  void FailureAnswered(const FailureReport& failure);
  void ResultsAnswered(const std::vector<FinishedUnit>& results);
  // This failure, or these results, could not be delivered: others go first now.
  void Postpone(const Batch& batch);

  // ---- The end
  // Accepts no more leases and returns those that wait.
  void Drain();
  // Whether nothing is being rendered and everything is returned and acknowledged.
  bool IsIdle() const;
  // Stops and returns what is being rendered.
  void StopRendering();

 private:
  void JoinFarm(FarmId farm);
  void AddLeases(const std::vector<Lease>& leases, const std::vector<LeaseId>& drop, TimePoint now);
  void AddFailure(FailureReport failure);

  FarmId farm_;  // of everything below but the scenes
  HeldLeases leases_;
  SceneTable scenes_;
  PreparationQueue preparations_;
  std::deque<FinishedUnit> results_;
  std::deque<FailureReport> failures_;
  bool results_first_ = false;  // after a failure that could not be delivered
  bool reports_last_ = false;   // after a report that could not be delivered
  uint64_t failure_count_ = 0;
  std::vector<LeaseId> returned_;  // to be reported
  bool draining_ = false;
};

}  // namespace tessera
