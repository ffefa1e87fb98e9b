// A worker as proto/work.proto describes it, without threads or network: what it holds, what it says, what it
// does with an answer. The simulation moves its messages and its time.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/instant.h"
#include "terms/terms.h"

namespace tessera {

struct WorkerTraits {
  int slots = 1;
  double speed = 1;           // model cost per second
  double load_s = 0.1;        // to load a scene
  double failure_chance = 0;  // of a unit
  double damage_chance = 0;   // of a result
};

class WorkerModel {
 public:
  WorkerModel(WorkerId id, WorkerTraits traits) : id_(id), traits_(traits) {}

  WorkerId id() const { return id_; }
  const WorkerTraits& traits() const { return traits_; }
  void set_speed(double speed) { traits_.speed = speed; }

  WorkerState State(Instant now, std::chrono::milliseconds wait);
  // Takes in an answer. The scenes it wants that are new: to be loaded.
  std::vector<SceneOrder> Apply(Instant now, const WorkerDirective& directive);
  void SceneLoaded(const Digest& scene) { scenes_[scene] = true; }
  // The next unit for an idle slot; it runs from now on.
  std::optional<Lease> Start(Instant now);
  // Its result is on its way. False if it was dropped meanwhile.
  bool Rendered(Instant now, LeaseId lease);
  // The lease is over: its result was answered, or it failed.
  void Forget(LeaseId lease) { held_.erase(lease); }
  bool Holds(LeaseId lease) const { return held_.contains(lease); }
  bool idle() const { return held_.empty(); }

 private:
  struct Held {
    Lease lease;
    LeaseStage stage = LeaseStage::kWaiting;
    Instant since{};
  };
  WorkerId id_;
  WorkerTraits traits_;
  uint64_t sequence_ = 0;
  std::map<Digest, bool> scenes_;  // whether ready
  std::map<LeaseId, Held> held_;
  std::vector<LeaseId> order_;  // in which waiting leases are rendered
  std::set<LeaseId> seen_;
};

}  // namespace tessera
