// A worker process without threads or network: the real workload of a worker (worker/core), driven in
// simulated time. The simulation delivers its messages, renders its units and passes it the time.
#pragma once

#include <optional>
#include <vector>

#include "coordinator/core/schedule/instant.h"
#include "proto/terms.h"
#include "worker/core/workload.h"

namespace tessera {

struct WorkerTraits {
  int slots = 1;
  double speed = 1;             // model cost per second
  uint64_t machine = 0;         // that it runs on
  double load_s = 0.1;          // to load a scene
  double failure_chance = 0;    // of a unit
  double damage_chance = 0;     // of a result
  double lie_chance = 0;        // of a result: wrong sums of the right form
  bool never_prepares = false;  // what it prepares never ends
  bool is_ill = false;          // all sums are wrong, and equal on all workers of the machine
};

class WorkerModel {
 public:
  WorkerModel(WorkerId id, WorkerTraits traits) : id_(id), traits_(traits) {}

  WorkerId id() const { return id_; }
  const WorkerTraits& traits() const { return traits_; }
  void set_speed(double speed) { traits_.speed = speed; }
  Workload& load() { return load_; }
  uint64_t sequence() const { return sequence_; }  // of the last state

  // The clock of its machine, which has an origin of its own.
  static Workload::TimePoint At(Instant now) { return Workload::TimePoint(now); }

  // The state that it sends next.
  WorkerState State(Instant now);
  // Applies the answer to the state `sent`.
  void Apply(Instant now, const WorkerState& sent, const WorkerDirective& directive);
  // The next unit for an idle slot; it runs from now on.
  std::optional<UnitTask> StartUnit(Instant now);
  // The slot is free again, whether the unit was finished or not.
  void SlotFreed() { --running_; }
  void SceneLoaded(const Digest& scene);

 private:
  WorkerId id_;
  WorkerTraits traits_;
  Workload load_;
  uint64_t sequence_ = 0;
  int running_ = 0;
};

}  // namespace tessera
