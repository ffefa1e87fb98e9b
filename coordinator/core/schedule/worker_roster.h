// The workers that the farm knows: who they are, how fast they are, whether they may work, and what they are
// to be told. Owned by the scheduler. All lists are ordered, because order reaches decisions; lookups are
// hashed.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coordinator/core/schedule/failure_book.h"
#include "coordinator/core/schedule/instant.h"
#include "coordinator/core/schedule/lease_table.h"
#include "coordinator/core/schedule/occupancy.h"
#include "coordinator/core/schedule/policy.h"
#include "coordinator/core/schedule/worker_pace.h"
#include "proto/terms.h"

namespace tessera {

// What goes into the next answer to a worker.
struct PendingDirective {
  std::vector<LeaseId> leases;  // not announced yet
  std::vector<LeaseId> drops;
  bool has_scenes = false;    // WorkerRecord::wanted has changed
  bool has_prefetch = false;  // WorkerRecord::prefetch has changed
  bool has_notice = false;    // whether it may work has changed
  bool empty() const {
    return leases.empty() && drops.empty() && !has_scenes && !has_prefetch && !has_notice;
  }
};

struct WorkerRecord {
  WorkerId id{};
  MemberId member{};  // whose certificate it has; 0: none
  std::string name, software_version;
  std::set<std::string> tags;
  uint64_t machine = 0;  // the same for all workers on it; 0: not known
  int slots = 1;
  bool is_live = false;     // connected
  bool is_leaving = false;  // it said so itself
  bool is_drained = false;  // by the operator
  std::string quarantine;   // its reason; empty if the worker is not in quarantine
  Instant last_contact{};
  bool has_joined = false;  // in this process of the coordinator
  uint64_t sequence = 0;    // of its last state
  Instant sequence_at{};    // when that arrived

  double speed = 1;  // relative to the reference machine that costs are expressed in
  uint64_t speed_measurements = 0;
  WorkerPace pace;  // of the last minute

  std::map<Digest, bool> scenes;            // listed by the last state; whether each is ready
  bool is_fetching = false;                 // files of one that is not ready
  std::vector<SceneRequest> wanted;         // to be loaded
  std::map<Digest, Instant> loading_since;  // when it was first directed to load it
  std::vector<Digest> prefetch;             // packages whose files are to be fetched meanwhile

  PendingDirective pending;
  std::set<LeaseId> revoked;  // the latest that were taken away on purpose: not to be taken over again

  uint64_t memory_bytes = 0;  // of its process; 0: not known
  uint64_t units_finished = 0, units_failed = 0;
  std::string last_failure;  // its reason
  int strikes = 0;
  int units_since_strike = 0;

  bool is_quarantined() const { return !quarantine.empty(); }
  // Whether later processes of its member may have to answer for it.
  bool is_faulty() const { return has_joined && member != MemberId{} && (strikes > 0 || is_quarantined()); }
  bool is_blocked() const { return is_drained || is_quarantined(); }
  bool may_work() const { return is_live && !is_leaving && !is_blocked(); }
  bool has_tags(const std::set<std::string>& required) const {
    return std::includes(tags.begin(), tags.end(), required.begin(), required.end());
  }
  bool is_loading() const {
    return std::any_of(scenes.begin(), scenes.end(), [](const auto& scene) { return !scene.second; });
  }
  bool has_ready(const Digest& scene) const {
    const auto found = scenes.find(scene);
    return found != scenes.end() && found->second;
  }
  bool wants(const Digest& scene) const {
    return std::any_of(wanted.begin(), wanted.end(),
                       [&](const SceneRequest& order) { return order.key == scene; });
  }
  // Whether it is to load a scene that it does not have ready.
  bool waits_for_scene() const {
    return std::any_of(wanted.begin(), wanted.end(),
                       [&](const SceneRequest& order) { return !has_ready(order.key); });
  }
  // Whether it has the scene or was told to load it.
  bool Expects(const Digest& scene) const {
    return scenes.contains(scene) || loading_since.contains(scene) || wants(scene);
  }

 private:
  friend class WorkerRoster;
  std::optional<Instant> gone_since_;  // while it is neither connected nor blocked
  std::optional<MemberId> faulty_of_;  // while it is faulty and not connected
  // What the roster has added to its totals for this worker.
  double speed_counted_ = 0;
  int slots_counted_ = 0;
  std::optional<uint64_t> machine_counted_;
  SlotUse use_counted_;
};

// Whether a worker is kept from work and why. Neither: it is no longer.
struct WorkerBlock {
  WorkerId worker{};
  std::string name;
  bool is_drained = false;
  std::string quarantine;
};

class WorkerRoster {
 public:
  // ---- Records ----
  // Return nullptr if there is no such worker.
  WorkerRecord* Find(WorkerId id);
  const WorkerRecord* Find(WorkerId id) const;
  WorkerRecord& At(WorkerId id) { return *by_id_.at(id); }
  std::map<WorkerId, WorkerRecord>& all() { return workers_; }
  const std::map<WorkerId, WorkerRecord>& all() const { return workers_; }
  size_t size() const { return workers_.size(); }
  bool empty() const { return workers_.empty(); }
  // Whether there is no place for another worker, not even that of one that has gone.
  bool is_full() const { return workers_.size() >= kWorkersMax && gone_.empty(); }

  // ---- Coming and going ----
  // Makes a place for a new worker if there is none: forgets the one that has been away for longest, and
  // returns its id.
  std::optional<WorkerId> MakePlace();
  // Updates the worker from the state that it sent. True if it was not connected before.
  std::pair<WorkerRecord*, bool> Admit(Instant now, const WorkerState& state);
  // The worker is not connected any more. It is remembered for some time, but gives its place up to a new
  // one.
  void Disconnect(Instant now, WorkerRecord& worker);
  // Connected workers whose last state is too old.
  std::vector<WorkerId> Silent(Instant now) const;
  // Removes those that have been away for too long and returns their ids.
  std::vector<WorkerId> ForgetGone(Instant now);

  // ---- Speed and slots ----
  // A unit that would have taken a worker of speed 1 `cost` seconds took this one `seconds`.
  void MeasureSpeed(WorkerRecord& worker, double cost, double seconds, bool is_tile_measured);
  // Call after every change of what the totals are made of.
  void UpdateTotals(WorkerRecord& worker);
  void UpdateSlotUse(WorkerRecord& worker, size_t lease_count);
  double total_speed() const { return total_speed_; }  // slots times speed of the workers that may work
  int total_slots() const { return total_slots_; }     // theirs
  // Whether all workers that may work run on one machine, as far as is known.
  bool is_one_machine() const { return machines_.size() <= 1 && !machines_.contains(0); }
  Occupancy& occupancy() { return occupancy_; }
  const Occupancy& occupancy() const { return occupancy_; }

  // ---- Blocks ----
  // Counts a failure of the worker. True if it should be quarantined.
  bool AddStrike(WorkerRecord& worker);
  static void CreditUnit(WorkerRecord& worker);
  // Each returns false if it changes nothing.
  bool Quarantine(WorkerRecord& worker, const std::string& reason);
  bool Drain(WorkerRecord& worker);
  bool Release(WorkerRecord& worker);  // from both; forgives its strikes
  void RestoreBlock(Instant now, const WorkerBlock& block);
  // A new process that was admitted takes over a drain from one of the same name and member that has gone,
  // and a quarantine if it is of the same machine and of a member: a restart does not end them. Blocks of a
  // former process of the coordinator name neither member nor machine, and those count as the same. Returns
  // the worker that had the block.
  std::optional<WorkerId> TakeOverBlock(WorkerRecord& worker);
  // A new process that was admitted takes over the strikes of those of the same member and machine that have
  // gone: a restart does not forgive them. A machine that is new to the farm may be any of them with another
  // number, and one that stands in for a process in quarantine is in quarantine after its first failure.
  // Workers without a certificate begin anew.
  void TakeOverStrikes(WorkerRecord& worker);
  std::vector<WorkerBlock> Blocks() const;
  // Blocks that were set or lifted since the last call.
  std::vector<WorkerBlock> TakeBlocks() { return std::exchange(changed_blocks_, {}); }
  // Workers that may work on a job that requires these tags.
  std::set<WorkerId> AbleFor(const std::set<std::string>& tags) const;
  // Whose workers those are.
  std::set<Party> PartiesFor(const std::set<std::string>& tags) const;
  // Why none may, for people; call it only if that is so.
  std::string WhyNoneFor(const std::set<std::string>& tags) const;

  // ---- The next directives ----
  void Announce(WorkerRecord& worker, LeaseId lease);
  void Drop(WorkerRecord& worker, LeaseId lease);
  // A drop of what was taken away on purpose, even if a state on its way still lists it.
  void Revoke(WorkerRecord& worker, LeaseId lease);
  void RequestScene(WorkerRecord& worker, const SceneRequest& scene);
  void RequestPrefetch(WorkerRecord& worker, std::vector<Digest> packages);
  bool HasNews(WorkerId id) const;
  // Workers that HasNews may be true for; all others have none.
  const std::set<WorkerId>& news() const { return news_; }
  // Scenes, prefetch and notice. The leases and drops are the scheduler's to fill in.
  WorkerDirective TakeRequests(Instant now, WorkerRecord& worker);
  void UpdateNews(const WorkerRecord& worker);

  std::vector<WorkerStatus> Statuses(Instant now, const LeaseTable& leases) const;

 private:
  void NoteBlock(WorkerRecord& worker);
  void CountMachine(WorkerRecord& worker);
  std::string WhyIdle(const std::set<std::string>& tags) const;
  size_t CountAway(const std::set<std::string>& tags) const;

  // The worker's record; a new one if there is none.
  WorkerRecord& FindOrAdd(WorkerId id);
  // Call after every change of whether the worker is connected or blocked.
  void UpdateGone(WorkerRecord& worker);
  void UpdateFaulty(WorkerRecord& worker);
  bool IsNewMachine(const WorkerRecord& worker) const;
  // Of the block of a process that has gone, what applies to the worker.
  static WorkerBlock InheritedBlock(const WorkerRecord& gone, const WorkerRecord& worker);
  void Forget(WorkerId id);

  std::map<WorkerId, WorkerRecord> workers_;
  // Of all; every result looks up its worker several times.
  std::unordered_map<WorkerId, WorkerRecord*> by_id_;
  // Workers that are not connected and not blocked, the one that has been away for longest first.
  std::set<std::pair<Instant, WorkerId>> gone_;
  std::set<WorkerId> gone_blocked_;                     // not connected, and blocked
  std::map<MemberId, std::set<WorkerId>> gone_faulty_;  // not connected, by member
  std::set<WorkerId> news_;
  double total_speed_ = 0;
  int total_slots_ = 0;
  std::map<uint64_t, size_t> machines_;  // of the workers that may work, and their number on each
  Occupancy occupancy_;
  std::vector<WorkerBlock> changed_blocks_;
};

}  // namespace tessera
