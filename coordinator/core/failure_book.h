// Which workers failed what of one frame, in their own words, and whether that condemns the unit. Owned by
// the scheduler.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/frame_work.h"
#include "coordinator/core/instant.h"
#include "proto/terms.h"

namespace tessera {

class FailureBook {
 public:
  struct Entry {
    std::optional<TileSamples> samples;  // nothing: the whole scene
    WorkerId worker{};
    std::string words;  // begin with the worker's name
    Instant at{};
  };

  // The same failure of the same worker again is not counted. Full at kFailuresKeptMax.
  void Record(Entry entry);
  // Whether the worker has failed neither a unit of the tile nor the scene: it never gets back what it
  // failed, and what it failed once will be taken in other ranges.
  bool May(WorkerId worker, uint32_t tile) const;
  bool HasFailedScene(WorkerId worker) const { return failed_scene_.contains(worker); }
  // Takes out what has been shown to be the worker's own fault, because `by` did it: of the samples of a tile
  // those that `is_done`, and failures of the whole scene by others. The workers at fault, once per failure.
  std::vector<WorkerId> Disprove(uint32_t tile, WorkerId by, const std::function<bool(TileSamples)>& is_done);
  // The words of the failures that condemn a tile or the scene: `attempts_max` different workers failed it.
  // Otherwise nothing.
  std::optional<std::string> Condemned(int attempts_max) const;
  // The same if all of `workers` (not empty) failed the same tile or the scene, the last of them before
  // `before`.
  std::optional<std::string> CondemnedByAll(const std::set<WorkerId>& workers, Instant before) const;
  bool empty() const { return entries_.empty(); }

 private:
  // All failures that hit the tile of `entry`, one for each worker.
  std::map<WorkerId, const Entry*> Against(const Entry& entry) const;

  std::vector<Entry> entries_;
  std::set<WorkerId> failed_scene_;  // stays when disproved: a worker never gets back what it failed
};

}  // namespace tessera
