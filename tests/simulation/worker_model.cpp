#include "tests/simulation/worker_model.h"

#include <algorithm>

namespace tessera {

WorkerState WorkerModel::State(Instant now, std::chrono::milliseconds wait) {
  WorkerState state;
  state.worker = id_;
  state.sequence = ++sequence_;
  state.name = "w" + std::to_string(Number(id_));
  state.slots = traits_.slots;
  state.wait = wait;
  for (const auto& [scene, ready] : scenes_) state.scenes.push_back({scene, ready});
  for (const auto& [id, held] : held_) {
    const auto duration = std::chrono::duration_cast<std::chrono::milliseconds>(now - held.since);
    state.leases.push_back({id, held.lease.unit, held.stage, duration});
  }
  return state;
}

std::vector<SceneOrder> WorkerModel::Apply(Instant now, const WorkerDirective& directive) {
  for (const LeaseId id : directive.drop) {
    held_.erase(id);
    seen_.insert(id);
  }
  for (const Lease& lease : directive.leases) {
    if (!seen_.insert(lease.id).second) continue;
    held_[lease.id] = {lease, LeaseStage::kWaiting, now};
    order_.push_back(lease.id);
  }
  std::vector<SceneOrder> wanted;
  for (const SceneOrder& scene : directive.scenes) {
    if (scenes_.emplace(scene.key, false).second) wanted.push_back(scene);
  }
  return wanted;
}

std::optional<Lease> WorkerModel::Start(Instant now) {
  const auto running = std::count_if(
      held_.begin(), held_.end(), [](const auto& each) { return each.second.stage == LeaseStage::kRunning; });
  if (running >= traits_.slots) return std::nullopt;
  while (!order_.empty()) {
    const LeaseId next = order_.front();
    order_.erase(order_.begin());
    const auto held = held_.find(next);
    if (held == held_.end()) continue;
    held->second.stage = LeaseStage::kRunning;
    held->second.since = now;
    return held->second.lease;
  }
  return std::nullopt;
}

bool WorkerModel::Rendered(Instant now, LeaseId lease) {
  const auto held = held_.find(lease);
  if (held == held_.end()) return false;
  held->second.stage = LeaseStage::kReturning;
  held->second.since = now;
  return true;
}

}  // namespace tessera
