#include "worker/workbench.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

void Workbench::Apply(const WorkerDirective& directive) {
  {
    const std::lock_guard lock(mutex_);
    load_.Apply(directive, Clock::now());
    idle_changed_.notify_all();
  }
  scenes_changed_.notify_all();
  units_changed_.notify_all();
}

void Workbench::AddLeases(const std::vector<Lease>& leases, const std::vector<LeaseId>& drop) {
  if (leases.empty() && drop.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    load_.AddLeases(leases, drop, Clock::now());
    idle_changed_.notify_all();
  }
  units_changed_.notify_all();
}

void Workbench::FillState(WorkerState& state) const {
  const std::lock_guard lock(mutex_);
  load_.FillState(state, Clock::now());
}

void Workbench::ReturnsHeard(const std::vector<LeaseId>& returned) {
  const std::lock_guard lock(mutex_);
  load_.ReturnsHeard(returned);
  idle_changed_.notify_all();
}

std::optional<UnitTask> Workbench::AwaitUnit(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  std::optional<UnitTask> task;
  units_changed_.wait(lock, stop, [&] {
    task = load_.StartUnit(Clock::now());
    return task.has_value();
  });
  return task;
}

void Workbench::UnitFinished(FinishedUnit unit) {
  {
    const std::lock_guard lock(mutex_);
    load_.UnitFinished(std::move(unit), Clock::now());
    idle_changed_.notify_all();
  }
  parcels_changed_.notify_all();
}

void Workbench::UnitFailed(const Lease& lease, std::string reason) {
  {
    const std::lock_guard lock(mutex_);
    load_.UnitFailed(lease, std::move(reason));
  }
  parcels_changed_.notify_all();
}

void Workbench::UnitStopped(LeaseId lease) {
  const std::lock_guard lock(mutex_);
  load_.UnitStopped(lease);
  idle_changed_.notify_all();
}

std::optional<SceneOrder> Workbench::AwaitSceneOrder(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  std::optional<SceneOrder> order;
  const auto has_order = [&] {
    order = load_.StartScene(Clock::now());
    return order.has_value();
  };
  while (!order && !stop.stop_requested()) {
    if (const auto retry = load_.NextRetry()) {
      scenes_changed_.wait_until(lock, stop, *retry, has_order);
      if (!order) has_order();
    } else {
      scenes_changed_.wait(lock, stop, has_order);
    }
  }
  return order;
}

void Workbench::SceneLoaded(const Digest& key, SceneShelf::ScenePointer scene) {
  {
    const std::lock_guard lock(mutex_);
    load_.SceneLoaded(key, std::move(scene));
  }
  units_changed_.notify_all();
  on_news_();
}

void Workbench::SceneFailed(const Digest& key, std::string reason) {
  {
    const std::lock_guard lock(mutex_);
    load_.SceneFailed(key, std::move(reason), Clock::now());
  }
  parcels_changed_.notify_all();
  on_news_();
}

Workbench::Parcel Workbench::AwaitParcel(size_t bytes_max, std::stop_token stop) {
  std::unique_lock lock(mutex_);
  parcels_changed_.wait(lock, stop, [this] { return load_.HasParcel(); });
  return load_.NextParcel(bytes_max);
}

void Workbench::FailureAnswered() {
  const std::lock_guard lock(mutex_);
  load_.FailureAnswered();
  idle_changed_.notify_all();
}

void Workbench::ResultsAnswered(const std::vector<FinishedUnit>& results) {
  const std::lock_guard lock(mutex_);
  load_.ResultsAnswered(results);
  idle_changed_.notify_all();
}

void Workbench::Drain() {
  {
    const std::lock_guard lock(mutex_);
    load_.Drain();
  }
  on_news_();
}

bool Workbench::AwaitIdle(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return idle_changed_.wait_for(lock, patience, [this] { return load_.IsIdle(); });
}

void Workbench::StopRendering() {
  {
    const std::lock_guard lock(mutex_);
    load_.StopRendering();
  }
  on_news_();
}

}  // namespace tessera
