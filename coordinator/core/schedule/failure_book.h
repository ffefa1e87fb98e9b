// Which workers failed what of one frame and for which reasons, who may still render it, and whether that
// means that a unit cannot be rendered. A worker is kept from what it failed only as long as nobody has shown
// that it can be done. Owned by the scheduler.
#pragma once

#include <functional>
#include <map>
#include <memory>
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

  // Failures of one scene, by worker, and whether it is suspect (loss_book.h). Frames of the same scene share
  // this, whatever their jobs.
  struct SceneHistory {
    std::map<WorkerId, Entry> failures;
    bool is_suspect = false;
  };

  explicit FailureBook(std::shared_ptr<SceneHistory> scene = std::make_shared<SceneHistory>())
      : scene_(std::move(scene)) {}

  // Does nothing if the worker has failed the same before, or if there are kFailuresKeptMax entries.
  void Record(Entry entry);
  // Whether the worker may get units of the tile: neither has it failed nor is the tile or the scene suspect.
  bool May(WorkerId worker, uint32_t tile) const { return !HasFailed(worker, tile) && !IsSuspect(tile); }
  // Whether the worker has failed units of the tile or the scene. What it failed once may come back as other
  // ranges of the same tile, so the whole tile counts.
  bool HasFailed(WorkerId worker, uint32_t tile) const;
  void SetSuspects(bool scene, std::set<uint32_t> tiles);
  // Removes the failures that `by` has disproved by rendering a unit of the tile: those of samples of the
  // tile that `is_done`, and all of the scene. Returns the workers at fault, once per failure.
  std::vector<WorkerId> Disprove(uint32_t tile, WorkerId by, const std::function<bool(TileSamples)>& is_done);
  // Why a tile or the scene cannot be rendered: `attempts_max` different workers failed it. Returns nullopt
  // if there is no such tile.
  std::optional<std::string> FatalReason(int attempts_max) const;
  // The same if all of `workers` (not empty) failed the same tile or the scene, the last of them before
  // `before`.
  std::optional<std::string> FatalReasonOfAll(const std::set<WorkerId>& workers, Instant before) const;
  // Whether every worker may get every unit.
  bool empty() const {
    return entries_.empty() && scene_->failures.empty() && !scene_->is_suspect && suspect_tiles_.empty();
  }

 private:
  using Failures = std::map<WorkerId, const Entry*>;
  bool IsSuspect(uint32_t tile) const { return scene_->is_suspect || suspect_tiles_.contains(tile); }
  // All failures that hit the tile, one for each worker; nullopt: those of the scene.
  Failures Against(std::optional<uint32_t> tile) const;
  // The tiles that were failed, and nullopt for the scene.
  std::set<std::optional<uint32_t>> Failed() const;

  std::vector<Entry> entries_;  // of units
  std::shared_ptr<SceneHistory> scene_;
  std::set<uint32_t> suspect_tiles_;
};

}  // namespace tessera
