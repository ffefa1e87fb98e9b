#include "tests/simulation/worker_model.h"

#include <fmt/format.h>

namespace tessera {

// A scene as far as the simulation needs one: it is there.
class Scene {};

WorkerState WorkerModel::State(Instant now) {
  WorkerState state;
  state.worker = id_;
  state.sequence = ++sequence_;
  state.name = fmt::format("w{}", Number(id_));
  state.slots = traits_.slots;
  state.machine = traits_.machine;
  load_.FillState(state, At(now));
  return state;
}

void WorkerModel::Apply(Instant now, const WorkerState& sent, const WorkerDirective& directive) {
  load_.ReturnsAcknowledged(sent.returned_leases);
  if (sent.sequence == sequence_) {
    load_.Apply(directive, At(now));
  } else {
    load_.ApplyOvertaken(directive, At(now));
  }
}

std::optional<UnitTask> WorkerModel::StartUnit(Instant now) {
  if (running_ >= traits_.slots) return std::nullopt;
  auto task = load_.StartUnit(At(now));
  if (task) ++running_;
  return task;
}

void WorkerModel::SceneLoaded(const Digest& scene) {
  load_.SceneLoaded(scene, std::make_shared<const Scene>());
}

}  // namespace tessera
