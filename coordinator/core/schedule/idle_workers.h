// Workers that could hold more leases than they do. A worker is idle until it was looked at and there was
// nothing for it; from then on it is blocked, and looked at again when new work appears. Owned by the
// scheduler.
#pragma once

#include <set>

#include "proto/terms.h"

namespace tessera {

class IdleWorkers {
 public:
  // The worker may work and has room. Does nothing if it is blocked.
  void Add(WorkerId worker) {
    if (!blocked_.contains(worker)) idle_.insert(worker);
  }
  // The worker may not work or has no room.
  void Remove(WorkerId worker) {
    idle_.erase(worker);
    blocked_.erase(worker);
  }
  // There is nothing for the worker now.
  void Block(WorkerId worker) {
    idle_.erase(worker);
    blocked_.insert(worker);
  }
  // There may be something for every worker.
  void UnblockAll() { idle_.merge(blocked_); }

  const std::set<WorkerId>& idle() const { return idle_; }
  const std::set<WorkerId>& blocked() const { return blocked_; }

 private:
  std::set<WorkerId> idle_, blocked_;
};

}  // namespace tessera
