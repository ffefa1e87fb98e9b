#include "worker/workbench.h"

#include <algorithm>

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

// Of a lease's duration: it is told again this many times before it lapses.
constexpr int kTellingsPerLease = 3;

void Append(std::vector<LeaseId>& to, const std::vector<LeaseId>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

void Workbench::Apply(const WorkerDirective& directive) {
  {
    const std::lock_guard lock(mutex_);
    if (!draining_) scenes_.Want(directive.scenes, [this](const Digest& key) { return leases_.Uses(key); });
    AddLeasesLocked(directive.leases, directive.drop);
  }
  scenes_changed_.notify_all();
  units_changed_.notify_all();
}

void Workbench::AddLeases(const std::vector<Lease>& leases, const std::vector<LeaseId>& drop) {
  if (leases.empty() && drop.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    AddLeasesLocked(leases, drop);
  }
  units_changed_.notify_all();
}

void Workbench::AddLeasesLocked(const std::vector<Lease>& leases, const std::vector<LeaseId>& drop) {
  for (const Lease& lease : leases) {
    if (!leases_.Add(lease, Clock::now())) continue;
    if (!draining_ && scenes_.Expects(lease.scene)) continue;
    leases_.Forget(lease.id);
    returned_.push_back(lease.id);
  }
  for (const LeaseId id : drop) {
    leases_.Forget(id);
    std::erase_if(results_, [id](const FinishedUnit& unit) { return unit.lease == id; });
  }
  idle_changed_.notify_all();
}

void Workbench::FillState(WorkerState& state) const {
  const std::lock_guard lock(mutex_);
  state.scenes = scenes_.Held();
  state.leases = leases_.Held(Clock::now());
  state.returned_leases = returned_;
  state.draining = draining_;
  state.wait = kSynchronizeWaitMax;
  if (const auto shortest = leases_.ShortestDuration())
    state.wait = std::min(state.wait, *shortest / kTellingsPerLease);
}

void Workbench::ReturnsHeard(const std::vector<LeaseId>& returned) {
  const std::lock_guard lock(mutex_);
  std::erase_if(returned_, [&](LeaseId id) { return std::ranges::find(returned, id) != returned.end(); });
  idle_changed_.notify_all();
}

std::optional<UnitTask> Workbench::AwaitUnit(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  std::optional<LeaseBook::Started> started;
  const auto is_ready = [this](const Digest& key) { return scenes_.IsReady(key); };
  units_changed_.wait(lock, stop, [&] {
    started = leases_.Start(is_ready, Clock::now());
    return started.has_value();
  });
  if (!started) return std::nullopt;
  return UnitTask{started->lease, scenes_.Use(started->lease.scene), started->stop};
}

void Workbench::UnitFinished(FinishedUnit unit) {
  {
    const std::lock_guard lock(mutex_);
    if (leases_.Finish(unit.lease, Clock::now())) results_.push_back(std::move(unit));
    idle_changed_.notify_all();
  }
  parcels_changed_.notify_all();
}

void Workbench::UnitFailed(const Lease& lease, std::string reason) {
  {
    const std::lock_guard lock(mutex_);
    leases_.Forget(lease.id);
    failures_.push_back({lease.id, lease.unit, lease.scene, std::move(reason)});
  }
  parcels_changed_.notify_all();
}

void Workbench::UnitStopped(LeaseId lease) {
  const std::lock_guard lock(mutex_);
  leases_.Forget(lease);
  idle_changed_.notify_all();
}

std::optional<SceneOrder> Workbench::AwaitSceneOrder(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  std::optional<SceneOrder> order;
  const auto has_order = [&] {
    if (!draining_) order = scenes_.StartLoading(Clock::now());
    return order.has_value();
  };
  while (!order && !stop.stop_requested()) {
    if (const auto retry = scenes_.NextRetry()) {
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
    scenes_.Loaded(key, std::move(scene));
  }
  units_changed_.notify_all();
  on_news_();
}

void Workbench::SceneFailed(const Digest& key, std::string reason) {
  {
    const std::lock_guard lock(mutex_);
    scenes_.Failed(key, Clock::now());
    Append(returned_, leases_.TakeScene(key));
    failures_.push_back({LeaseId{}, {}, key, std::move(reason)});
  }
  parcels_changed_.notify_all();
  on_news_();
}

Workbench::Parcel Workbench::AwaitParcel(size_t bytes_max, std::stop_token stop) {
  std::unique_lock lock(mutex_);
  parcels_changed_.wait(lock, stop, [this] { return !failures_.empty() || !results_.empty(); });
  if (!failures_.empty()) return failures_.front();
  if (results_.empty()) return {};
  std::vector<FinishedUnit> results;
  size_t bytes = 0;
  for (const FinishedUnit& result : results_) {
    bytes += results.empty() ? 0 : result.tile.size();
    if (bytes > bytes_max || results.size() == static_cast<size_t>(kResultsPerCallMax)) break;
    results.push_back(result);
  }
  return results;
}

void Workbench::FailureAnswered() {
  const std::lock_guard lock(mutex_);
  failures_.pop_front();
  idle_changed_.notify_all();
}

void Workbench::ResultsAnswered(const std::vector<FinishedUnit>& results) {
  const std::lock_guard lock(mutex_);
  for (const FinishedUnit& answered : results) {
    leases_.Forget(answered.lease);
    std::erase_if(results_, [&](const FinishedUnit& unit) { return unit.lease == answered.lease; });
  }
  idle_changed_.notify_all();
}

void Workbench::Drain() {
  {
    const std::lock_guard lock(mutex_);
    draining_ = true;
    Append(returned_, leases_.TakeWaiting());
  }
  on_news_();
}

bool Workbench::IsIdle() const {
  return leases_.running() == 0 && results_.empty() && failures_.empty() && returned_.empty();
}

bool Workbench::AwaitIdle(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return idle_changed_.wait_for(lock, patience, [this] { return IsIdle(); });
}

void Workbench::StopRendering() {
  {
    const std::lock_guard lock(mutex_);
    Append(returned_, leases_.TakeRunning());
  }
  on_news_();
}

}  // namespace tessera
