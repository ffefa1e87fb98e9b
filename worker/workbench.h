// What the threads of a worker share: its workload under a lock, and ways to wait for a change of it. The
// threads that speak with the coordinator, that load scenes and that render meet only here.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "proto/terms.h"
#include "renderer/util/result.h"
#include "worker/core/workload.h"

namespace tessera {

// Thread safe. Waiting functions return empty-handed once `stop` is requested.
class Workbench {
 public:
  // `on_news` is called, from any thread and with no lock held, whenever the coordinator should hear of a
  // change that is no result.
  explicit Workbench(std::function<void()> on_news) : on_news_(std::move(on_news)) {}

  // ---- From the coordinator
  void Apply(const WorkerDirective& directive);
  // What came with the answer to results or a failure.
  void AddLeases(const std::vector<Lease>& leases, const std::vector<LeaseId>& drop);
  // What the coordinator is to hear: scenes, leases, returned leases and whether we drain. The wait is short
  // enough to keep the leases.
  void FillState(WorkerState& state) const;
  // The coordinator has answered a state that listed these.
  void ReturnsHeard(const std::vector<LeaseId>& returned);

  // ---- For the rendering threads
  std::optional<UnitTask> AwaitUnit(std::stop_token stop);
  void UnitFinished(FinishedUnit unit);
  void UnitFailed(const Lease& lease, std::string reason);
  // Its rendering was stopped because nobody wants it.
  void UnitStopped(LeaseId lease);

  // ---- For the thread that loads scenes
  std::optional<SceneOrder> AwaitSceneOrder(std::stop_token stop);
  void SceneLoaded(const Digest& key, SceneShelf::ScenePointer scene);
  void SceneFailed(const Digest& key, std::string reason);

  // ---- For the thread that returns
  // The next failure or the next results, at most `bytes_max` beyond the first. They stay here until
  // answered.
  using Parcel = Workload::Parcel;
  Parcel AwaitParcel(size_t bytes_max, std::stop_token stop);
  // The oldest failure, or these results, have been answered.
  void FailureAnswered();
  void ResultsAnswered(const std::vector<FinishedUnit>& results);

  // ---- The end
  // Takes no more leases and returns those that wait.
  void Drain();
  // Waits until nothing is being rendered and all is returned and heard, at most for `patience`; whether it
  // is so.
  bool AwaitIdle(std::chrono::milliseconds patience);
  // Stops and returns what is being rendered.
  void StopRendering();

 private:
  const std::function<void()> on_news_;
  mutable std::mutex mutex_;
  std::condition_variable_any units_changed_, scenes_changed_, parcels_changed_, idle_changed_;
  Workload load_;  // guarded by mutex_
};

}  // namespace tessera
