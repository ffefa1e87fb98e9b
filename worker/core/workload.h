// All that a worker has to do and has done: leases, scenes, and what is on its way back to the coordinator. A
// pure state machine: time comes in as an argument, and who waits for what is the shell's affair
// (worker/workbench.h).
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "proto/terms.h"
#include "worker/core/lease_book.h"
#include "worker/core/scene_shelf.h"

namespace tessera {

// Something rendered, as it travels.
struct FinishedUnit {
  LeaseId lease{};
  WorkUnit unit;
  std::string tile;  // EncodeRadianceTile
  double render_seconds = 0;
};

// Something that could not be done: a unit, or, with a lease of 0, a whole scene.
struct FailureReport {
  LeaseId lease{};
  WorkUnit unit;
  Digest scene;
  std::string reason;
};

// A unit to render, with all that it needs.
struct UnitTask {
  Lease lease;
  SceneShelf::ScenePointer scene;
  LeaseBook::StopFlag stop;
};

// Not thread safe.
class Workload {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  // ---- From the coordinator
  void Apply(const WorkerDirective& directive, TimePoint now);
  // What came with the answer to results or a failure.
  void AddLeases(const std::vector<Lease>& leases, const std::vector<LeaseId>& drop, TimePoint now);
  // What the coordinator is to hear: scenes, leases, returned leases and whether we drain. The wait is short
  // enough to keep the leases.
  void FillState(WorkerState& state, TimePoint now) const;
  // The coordinator has answered a state that listed these.
  void ReturnsHeard(const std::vector<LeaseId>& returned);

  // ---- Units
  // The next that can be rendered; it runs from now on.
  std::optional<UnitTask> StartUnit(TimePoint now);
  // False if it was dropped meanwhile, so that nobody wants the result.
  bool UnitFinished(FinishedUnit unit, TimePoint now);
  void UnitFailed(const Lease& lease, std::string reason);
  // Its rendering was stopped because nobody wants it.
  void UnitStopped(LeaseId lease) { leases_.Forget(lease); }

  // ---- Scenes
  // The next to load, which counts as loading from now on; none while we drain.
  std::optional<SceneOrder> StartScene(TimePoint now);
  // When StartScene may have something that it had not, if nothing else happens.
  std::optional<TimePoint> NextRetry() const { return draining_ ? std::nullopt : scenes_.NextRetry(); }
  void SceneLoaded(const Digest& key, SceneShelf::ScenePointer scene);
  void SceneFailed(const Digest& key, std::string reason, TimePoint now);

  // ---- What is to be returned
  bool HasParcel() const { return !failures_.empty() || !results_.empty(); }
  // The next failure or the next results, at most `bytes_max` beyond the first. They stay here until
  // answered.
  using Parcel = std::variant<std::monostate, FailureReport, std::vector<FinishedUnit>>;
  Parcel NextParcel(size_t bytes_max) const;
  // The oldest failure, or these results, have been answered.
  void FailureAnswered() { failures_.pop_front(); }
  void ResultsAnswered(const std::vector<FinishedUnit>& results);

  // ---- The end
  // Takes no more leases and returns those that wait.
  void Drain();
  // Whether nothing is being rendered and all is returned and heard.
  bool IsIdle() const;
  // Stops and returns what is being rendered.
  void StopRendering();

 private:
  LeaseBook leases_;
  SceneShelf scenes_;
  std::deque<FinishedUnit> results_;
  std::deque<FailureReport> failures_;
  std::vector<LeaseId> returned_;  // to be told
  bool draining_ = false;
};

}  // namespace tessera
