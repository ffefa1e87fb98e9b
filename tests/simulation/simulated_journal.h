// The coordinator's journal on a simulated disk: it may be full, and a crash loses some or all of what was
// not synced.
#pragma once

#include <string>
#include <vector>

#include "coordinator/core/journal.h"
#include "tests/simulation/random.h"

namespace tessera {

class SimulatedJournal : public Journal {
 public:
  void Append(const Fact& fact) override { pending_.push_back(EncodeFact(fact)); }
  Result<void> Sync(Room room = Room::kFree) override {
    if (pending_.empty()) return {};
    if (full_ && room == Room::kFree) return Failed("no space left on device");
    synced_.insert(synced_.end(), pending_.begin(), pending_.end());
    pending_.clear();
    return {};
  }

  // Small, so that journals are compacted in simulations.
  bool IsLarge() const override { return synced_.size() > 20; }
  Result<void> Replace(const std::vector<Fact>& facts) override {
    if (full_) return Failed("no space left on device");
    synced_.clear();
    for (const Fact& fact : facts) synced_.push_back(EncodeFact(fact));
    return {};
  }

  void set_full(bool full) { full_ = full; }
  // The process is killed during a write: the first records that were not synced may be there.
  void Crash(Random& random) {
    pending_.resize(static_cast<size_t>(random.Int(0, static_cast<int>(pending_.size()))));
    synced_.insert(synced_.end(), pending_.begin(), pending_.end());
    pending_.clear();
  }
  // What the next process finds.
  const std::vector<std::string>& facts() const { return synced_; }

 private:
  std::vector<std::string> synced_, pending_;  // EncodeFact
  bool full_ = false;
};

}  // namespace tessera
