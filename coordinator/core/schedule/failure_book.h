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
#include "proto/failure_cause.h"
#include "proto/membership.h"
#include "proto/terms.h"

namespace tessera {

// Whose failures count as one: a member with all its workers, so that nobody gains by making up process
// numbers. A worker without a certificate is a party by itself.
using Party = std::pair<MemberId, WorkerId>;
inline Party PartyOf(MemberId member, WorkerId worker) {
  return {member, member == MemberId{} ? worker : WorkerId{}};
}

class FailureBook {
 public:
  struct Entry {
    std::optional<TileSamples> samples;  // nullopt: the whole scene
    WorkerId worker{};
    MemberId member{};   // the worker's; 0: none
    std::string reason;  // starts with the worker's name
  };

  // What is known of one scene: who failed to load it because of the scene or of a limit of its own, whether
  // it is suspect (loss_book.h), and whether a unit of it was rendered since this process began, so that it
  // can be loaded. Frames of the same scene share this, whatever their jobs.
  struct SceneHistory {
    std::map<WorkerId, Entry> failures, limits;
    bool is_suspect = false;
    bool is_rendered = false;
  };

  // Why something cannot be rendered.
  struct Reason {
    bool is_scene = false;  // the whole scene, not one tile
    std::string text;
  };

  explicit FailureBook(std::shared_ptr<SceneHistory> scene = std::make_shared<SceneHistory>())
      : scene_(std::move(scene)) {}

  // Does nothing if the worker has failed the same before, or if there are kFailuresKeptMax entries.
  void Record(Entry entry, FailureCause cause = FailureCause::kScene);
  // A unit of the frame was rendered.
  void NoteRendered() { scene_->is_rendered = true; }
  bool IsSceneRendered() const { return scene_->is_rendered; }
  // Whether the worker may get units of the tile: neither has it failed nor is the tile or the scene suspect.
  bool May(WorkerId worker, uint32_t tile) const { return !HasFailed(worker, tile) && !IsSuspect(tile); }
  bool HasFailedScene(WorkerId worker) const {
    return scene_->failures.contains(worker) || scene_->limits.contains(worker);
  }
  // Whether the worker has failed units of the tile or the scene. What it failed once may come back as other
  // ranges of the same tile, so the whole tile counts.
  bool HasFailed(WorkerId worker, uint32_t tile) const;
  void SetSuspects(bool scene, std::set<uint32_t> tiles);
  // Whether a rendered unit may disprove failures.
  bool CanDisprove() const {
    return !entries_.empty() || !scene_->failures.empty() || scene_->is_suspect || !suspect_tiles_.empty();
  }
  // Removes the failures that `by` has disproved by rendering a unit of the tile: those of samples of the
  // tile that `is_done`, and those of the scene that were not due to a limit of the worker. Returns the
  // workers at fault, once per failure.
  std::vector<WorkerId> Disprove(uint32_t tile, WorkerId by, const std::function<bool(TileSamples)>& is_done);
  // Why a tile or the scene cannot be rendered: `attempts_max` different workers of as many parties failed
  // it, and not for a limit of their own. Of fewer parties, if those that failed it and those of
  // `find_parties`, who could render it, are fewer. Returns nullopt if there is no such tile.
  std::optional<Reason> FatalReason(int attempts_max,
                                    const std::function<std::set<Party>()>& find_parties) const;
  // The same if all of `workers` (not empty) failed the same tile or the scene, for whatever reason.
  std::optional<Reason> ReasonOfAll(const std::set<WorkerId>& workers) const;
  // The same if that has been so for `grace`, as noticed by calls of this. A scene that was rendered can be
  // loaded by somebody, who is waited for.
  std::optional<Reason> FatalReasonOfAll(Instant now, const std::set<WorkerId>& workers, Instant grace);
  // Whether every worker may get every unit.
  bool empty() const { return !CanDisprove() && scene_->limits.empty(); }

 private:
  using Failures = std::map<WorkerId, const Entry*>;
  bool IsSuspect(uint32_t tile) const { return scene_->is_suspect || suspect_tiles_.contains(tile); }
  // All failures that hit the tile, one for each worker; nullopt: those of the scene.
  Failures Against(std::optional<uint32_t> tile) const;
  // The tiles that were failed, and nullopt for the scene.
  std::set<std::optional<uint32_t>> Failed() const;
  // What all of the workers failed. A scene that was rendered: only tiles that one of them has tried.
  std::optional<Reason> ReasonOfAll(const std::set<WorkerId>& workers, bool is_fatal) const;

  std::vector<Entry> entries_;  // of units
  std::shared_ptr<SceneHistory> scene_;
  std::set<uint32_t> suspect_tiles_;
  std::optional<Instant> none_may_since_;  // as noticed by FatalReasonOfAll
};

}  // namespace tessera
