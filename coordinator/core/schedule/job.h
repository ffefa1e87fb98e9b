// What the coordinator knows of a job: one record that the farm owns in its job table and the scheduler works
// on. Ordered containers only: order reaches decisions.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/schedule/active_frames.h"
#include "coordinator/core/schedule/counters.h"
#include "coordinator/core/schedule/failure_book.h"
#include "coordinator/core/schedule/frame_work.h"
#include "coordinator/core/schedule/instant.h"
#include "coordinator/core/schedule/picture_file.h"
#include "coordinator/core/schedule/verification.h"
#include "proto/terms.h"
#include "renderer/film/channel_layout.h"
#include "renderer/film/merger.h"
#include "renderer/util/hash.h"

namespace tessera {

// A frame that is begun and not complete, as the scheduler sees it.
struct ActiveFrame {
  // The first `samples_done` samples of every pixel are done.
  ActiveFrame(const JobSpec& submitted, uint32_t index, const Digest& scene_key, const FrameSpec& frame,
              uint32_t samples_done, bool has_one_scene)
      : scene(RequestFor(submitted, submitted.frames[index], scene_key, has_one_scene)),
        layout(frame.Layout()),
        work(frame, samples_done, submitted.first ? PixelsOf(*submitted.first, frame) : PixelBounds{}),
        verification(submitted.verify_share, Hash(submitted.submission, index)) {}

  SceneRequest scene;
  ChannelLayout layout;  // of results
  FrameWork work;
  FailureBook failures;
  Verification verification;
  std::shared_ptr<const void> place;  // counts it among the active frames of all jobs

 private:
  static SceneRequest RequestFor(const JobSpec& job, const FrameRequest& order, const Digest& scene_key,
                                 bool has_one_scene) {
    return {scene_key, job.package, order.scene_file, order.options, order.spec, has_one_scene};
  }
};

// Where a job stands between its first unit and its last.
enum class JobPhase {
  kOpen,     // there are units to hand out
  kTail,     // every unit that is left is held by a worker
  kRendered  // all are done
};

// The scheduler's part of a job; empty unless the job is open.
struct JobSchedule {
  bool has_one_scene = true;  // all frames are of the same file
  std::map<uint32_t, ActiveFrame> active;
  std::set<uint32_t> ahead;                                      // frames that are not begun
  std::optional<std::pair<uint32_t, ActiveFrames::Size>> sized;  // the frame whose size was last computed
  double load_s = 0;            // that a worker takes to get a scene of it ready; 0: not known
  double measured_cost = 0;     // of all its frames, in seconds on a worker of speed 1
  double measured_samples = 0;  // pixel samples that cost that

  bool HasOpen() const {
    if (!ahead.empty()) return true;
    for (const auto& [index, frame] : active) {
      if (frame.work.HasOpen()) return true;
    }
    return false;
  }
  bool is_rendered() const { return active.empty() && ahead.empty(); }
};

// The moments that divide the time of a job, as the farm's counters stood then.
struct JobClock {
  FarmCounters begun, tail, rendered, ended;
  JobPhase phase = JobPhase::kOpen;
  double render_s = 0, waste_s = 0;  // of slots, on this job
};

// The noise of complete frames (Merger::noise).
class NoiseOfFrames {
 public:
  void Set(uint32_t frame, double noise) {
    double& known = by_frame_[frame];
    sum_ += noise - known;
    known = noise;
  }
  double sum() const { return sum_; }
  size_t count() const { return by_frame_.size(); }

 private:
  std::map<uint32_t, double> by_frame_;
  double sum_ = 0;
};

// What came in for a job and what became of it; the farm's part.
struct JobResults {
  struct Progress {
    Instant at{};
    uint64_t samples = 0;
  };
  uint64_t samples_done = 0, samples_total = 0;  // pixel samples
  uint64_t samples_accepted = 0;                 // by this process, duplicates included
  std::deque<Progress> progress;                 // of the last seconds
  std::map<uint32_t, Merger> mergers;            // of frames begun and not complete
  std::set<uint32_t> loading;                    // frames whose earlier sums are on their way from the spool
  std::set<uint32_t> writing;                    // frames that are complete and not written
  std::map<uint32_t, PictureFile> files;         // of frames that are written
  std::map<uint32_t, std::string> failed;        // why no worker can render frames
  std::map<uint32_t, uint64_t> frame_samples;    // pixel samples of frames that are complete
  NoiseOfFrames noise;                           // of frames that this process completed
  std::set<uint32_t> remaking;                   // frames whose damaged file is made again from their sums
  std::map<uint32_t, std::string> unwritten;     // why attempts to write the pictures of frames failed
  std::map<uint32_t, std::string> lost;          // why files are damaged or missing and cannot be made again

  std::map<WorkerId, uint64_t> unconfirmed;  // units merged of each worker, if some are verified
  uint64_t units_verified = 0, units_disputed = 0, units_suspect = 0;
};

struct Job {
  JobId id{};
  JobOwner owner;
  // While a worker has not made its frames: its specifications have none then, and the scheduler does not
  // know it.
  std::shared_ptr<const JobOrder> order;
  std::string order_problem;  // why nobody has made them yet, or empty
  std::shared_ptr<const JobSpec> submitted;
  std::shared_ptr<const JobSpec> spec;  // as submitted, or extended since
  uint64_t spec_bytes = 0;              // MemoryOf(*submitted)
  JobState state = JobState::kWaiting;
  std::string reason;
  bool is_paused = false;  // by the user
  int32_t priority = 0;
  Instant began{}, ended{};              // also in former processes
  std::optional<JobTimes> former_times;  // of a job that a former process ended
  // Frames without results since their job was extended: samples per pixel whose sums are in the spool alone.
  std::map<uint32_t, uint32_t> in_spool;

  JobSchedule schedule;
  JobResults results;
  JobClock clock;
  mutable std::map<uint32_t, Digest> scene_keys;  // of frames that it was asked for: SceneOf

  // Names what the frame is rendered from, as it was submitted: an extended frame keeps its key, and its
  // results.
  const Digest& SceneOf(uint32_t frame) const {
    const auto [known, is_new] = scene_keys.try_emplace(frame);
    const FrameRequest& request = submitted->frames[frame];
    if (is_new)
      known->second = SceneKey(submitted->package, request.scene_file, request.options, request.spec);
    return known->second;
  }
  // Whether the unit is of a frame of this job, not of what another data directory or another history of this
  // one calls by the same numbers.
  bool Has(const WorkUnit& unit) const {
    return unit.frame < submitted->frames.size() && unit.scene == SceneOf(unit.frame);
  }

  // Makes the frame active. JobQueue::Begin lets it share what is known of its scene.
  ActiveFrame& Begin(uint32_t frame) {
    schedule.ahead.erase(frame);
    const auto done = in_spool.find(frame);
    return schedule.active
        .try_emplace(frame, *submitted, frame, SceneOf(frame), spec->frames[frame].spec,
                     done == in_spool.end() ? 0 : done->second, schedule.has_one_scene)
        .first->second;
  }
};

}  // namespace tessera
