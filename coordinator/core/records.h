// What the scheduler remembers of jobs, workers and leases. Plain data, in ordered containers only: order
// reaches decisions. Owned by the scheduler; nothing outside sees it.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/failure_book.h"
#include "coordinator/core/frame_work.h"
#include "coordinator/core/instant.h"
#include "coordinator/core/occupancy.h"
#include "coordinator/core/policy.h"
#include "coordinator/core/verification.h"
#include "coordinator/core/worker_pace.h"
#include "proto/terms.h"
#include "renderer/util/hash.h"

namespace tessera {

struct LeaseRecord {
  Lease lease;
  WorkerId worker{};
  std::optional<double> cost;  // expected when granted, on a worker of speed 1
  Instant granted{};
  Instant deadline{};
  Instant expected_start{}, expected_end{};
  Instant announced_at{};
  bool announced = false;  // put into some answer
  bool listed = false;     // by the worker's last state
  bool started = false;    // as far as the worker said
  double duration_s = 0;   // expected when granted
};

struct WorkerRecord {
  WorkerId id{};
  std::string name, software_version;
  std::set<std::string> tags;
  int slots = 1;
  bool live = false;
  bool draining = false;  // as it says itself
  bool drained = false;   // by people
  Instant last_contact{};
  uint64_t sequence = 0;  // of the last state

  double speed = 1;
  uint64_t speed_measurements = 0;
  double speed_counted = 0;  // of all slots, in the sum of all workers
  int slots_counted = 0;

  SlotUse use;      // as it is counted in the farm's occupancy
  WorkerPace pace;  // of the last minute

  std::map<Digest, bool> scenes;            // listed by the last state; whether ready
  bool fetching = false;                    // one of those that are not ready, its files
  std::vector<SceneOrder> wanted;           // to be loaded
  bool wanted_told = true;                  // `wanted` has been put into some answer
  std::map<Digest, Instant> loading_since;  // when it was told first
  std::vector<Digest> prefetch;             // packages whose files are to be fetched meanwhile
  bool prefetch_told = true;                // the same of these

  std::set<LeaseId> leases;  // in the order granted
  LeaseId begun{};           // those up to here have begun or are next, as far as one can guess
  double queue_cost = 0;     // of those whose cost is known
  int queue_unknown = 0;     // how many are not
  std::vector<LeaseId> unannounced;
  std::vector<LeaseId> drops;  // not told yet
  std::set<LeaseId> revoked;   // the last that were taken away on purpose: not to be taken over again

  uint64_t units_finished = 0, units_failed = 0;
  int strikes = 0;
  int units_since_strike = 0;
  std::string quarantine;  // its reason, or empty
  bool notice_told = true;

  bool quarantined() const { return !quarantine.empty(); }
  bool MayWork() const { return live && !draining && !is_barred(); }
  bool is_barred() const { return drained || quarantined(); }
  bool HasTags(const std::set<std::string>& required) const {
    return std::includes(tags.begin(), tags.end(), required.begin(), required.end());
  }
  bool IsLoading() const {
    return std::any_of(scenes.begin(), scenes.end(), [](const auto& scene) { return !scene.second; });
  }
  bool HasReady(const Digest& scene) const {
    const auto found = scenes.find(scene);
    return found != scenes.end() && found->second;
  }
  bool Wants(const Digest& scene) const {
    return std::any_of(wanted.begin(), wanted.end(),
                       [&](const SceneOrder& order) { return order.key == scene; });
  }
};

struct FrameRecord {
  // The scene is the one submitted; the frame may have more samples by now, `samples_done` of them done.
  FrameRecord(const JobSpec& submitted, uint32_t index, const FrameSpec& frame, uint32_t samples_done,
              bool has_one_scene)
      : scene(OrderFor(submitted, submitted.frames[index], has_one_scene)),
        work(frame, samples_done),
        verification(submitted.verify_share, Hash(submitted.submission, index)) {}
  static SceneOrder OrderFor(const JobSpec& job, const FrameOrder& order, bool has_one_scene) {
    return {SceneKey(job.package, order.scene_file, order.options),
            job.package,
            order.scene_file,
            order.options,
            order.spec,
            has_one_scene};
  }

  SceneOrder scene;
  FrameWork work;
  FailureBook failures;
  Verification verification;
  std::map<uint32_t, std::map<LeaseId, SampleRange>> leases;  // by tile
};

struct JobRecord {
  JobId id{};
  std::shared_ptr<const JobSpec> submitted;
  std::shared_ptr<const JobSpec> spec;  // as submitted, or extended since
  int priority = 0;
  bool has_one_scene = true;  // all frames are of the same file
  bool paused = false;
  std::map<uint32_t, FrameRecord> frames;  // those active: begun and not complete
  std::set<uint32_t> frames_ahead;         // not begun
  std::map<uint32_t, uint32_t> kept;       // samples per pixel that frames ahead have already
  size_t leases = 0;                       // held by workers now
  double leases_s = 0;                     // their expected durations together: its share of the farm
  double load_s = 0;                       // that a worker takes to get a scene of it ready; 0: not known
  double measured_cost = 0, measured_samples = 0;  // of all its frames: on a worker of speed 1; pixel samples
  std::map<WorkerId, uint32_t> holders;            // how many of them each holds

  FrameRecord& Begin(uint32_t frame) {
    frames_ahead.erase(frame);
    const auto done = kept.extract(frame);
    const uint32_t samples_done = done.empty() ? 0 : done.mapped();
    return frames.try_emplace(frame, *submitted, frame, spec->frames[frame].spec, samples_done, has_one_scene)
        .first->second;
  }
  bool HasOpen() const {
    if (!frames_ahead.empty()) return true;
    for (const auto& [index, frame] : frames) {
      if (frame.work.HasOpen()) return true;
    }
    return false;
  }
};

}  // namespace tessera
