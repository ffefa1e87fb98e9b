// Which workers failed what of one frame and for which reasons, and whether that means that the unit cannot
// be rendered. Owned by the scheduler.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/schedule/frame_work.h"
#include "coordinator/core/schedule/instant.h"
#include "proto/terms.h"

namespace tessera {

class FailureBook {
 public:
  struct Entry {
    std::optional<TileSamples> samples;  // nullopt: the whole scene
    WorkerId worker{};
    std::string reason;  // starts with the worker's name
    Instant at{};
  };

  // Does nothing if the worker has failed the same before, or if there are kFailuresKeptMax entries.
  void Record(Entry entry);
  // Whether the worker may get units of the tile: it has failed neither one of them nor the scene. What it
  // failed once may come back as other ranges of the same tile, so the whole tile counts.
  bool May(WorkerId worker, uint32_t tile) const;
  bool HasFailedScene(WorkerId worker) const { return failed_scene_.contains(worker); }
  // Removes the failures that were the worker's own fault, because `by` has rendered the unit: those of
  // samples of the tile that `is_done`, and failures of the whole scene by others. Returns the workers at
  // fault, once per failure.
  std::vector<WorkerId> Disprove(uint32_t tile, WorkerId by, const std::function<bool(TileSamples)>& is_done);
  // Why a tile or the scene cannot be rendered: `attempts_max` different workers failed it. Returns nullopt
  // if there is no such tile.
  std::optional<std::string> FatalReason(int attempts_max) const;
  // The same if all of `workers` (not empty) failed the same tile or the scene, the last of them before
  // `before`.
  std::optional<std::string> FatalReasonOfAll(const std::set<WorkerId>& workers, Instant before) const;
  bool empty() const { return entries_.empty(); }

 private:
  // All failures that hit the tile of `entry`, one for each worker.
  std::map<WorkerId, const Entry*> Against(const Entry& entry) const;

  std::vector<Entry> entries_;
  std::set<WorkerId> failed_scene_;  // not cleared by Disprove: a worker never gets back what it failed
};

}  // namespace tessera
