// The jobs with work to hand out, in the order of their priority, and how long their units should be. Jobs of
// equal priority share the farm's time. Owned by the scheduler.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "coordinator/core/schedule/active_frames.h"
#include "coordinator/core/schedule/job.h"

namespace tessera {

class JobQueue {
 public:
  using Priorities = std::map<int, std::set<JobId>, std::greater<int>>;

  // The record must stay where it is until Remove.
  void Add(Job& job);
  void Remove(Job& job);
  // A paused job is known but not runnable.
  void SetPaused(Job& job, bool is_paused);
  void SetPriority(Job& job, int priority);

  // Returns nullptr if there is no such open job.
  Job* Find(JobId id);
  const Job* Find(JobId id) const;
  Job& At(JobId id) { return *open_.at(id); }
  const Job& At(JobId id) const { return *open_.at(id); }
  // Whether there is room for one more active frame. The most urgent job has room for two while others fill
  // the limits.
  bool MayBegin(Job& job, uint32_t frame);
  // Whether there is room for one more that a worker needs because it finds no work in those that are active.
  bool MayStretch(Job& job, uint32_t frame);
  // Whether a frame may be begun for which there is no such room either: one at a time.
  bool MayExceed() const { return !active_.IsBeyond(kActiveStretch); }
  // Whether MayBegin was false since the last call of ClearRefusal.
  bool has_refused() const { return has_refused_; }
  bool ClearRefusal() { return std::exchange(has_refused_, false); }
  // Makes the frame active.
  ActiveFrame& Begin(Job& job, uint32_t frame);
  // The frame of the unit if it is begun and not complete.
  ActiveFrame* FindFrame(const WorkUnit& unit);
  // The same; begins the frame if it is ahead: a lease of a former process is known, or a result of it.
  ActiveFrame* FindOrBegin(const WorkUnit& unit);
  // Whether the unit can be a part of an open frame, begun or not, and is of that frame's scene.
  bool IsKnown(const WorkUnit& unit) const;
  const std::map<JobId, Job*>& open() const { return open_; }
  // Jobs that are not paused.
  const Priorities& runnable() const { return runnable_; }

  // Expected seconds of all open samples on a worker of speed 1; nullopt if some frame was never measured.
  static std::optional<double> OpenCost(const Job& job);
  // How long a unit of the job should take on any slot: guided sizing.
  static double UnitSeconds(const Job& job, int total_slots, double total_speed);
  // Packages of runnable jobs with open work in the order in which workers will come to them; some more than
  // kScenesAheadMax.
  std::vector<Digest> PackagesAhead() const;

 private:
  void Register(const Job& job) { runnable_[job.priority].insert(job.id); }
  void Unregister(const Job& job);

  std::map<JobId, Job*> open_;
  Priorities runnable_;
  ActiveFrames active_;
  bool has_refused_ = false;
  std::map<Digest, std::weak_ptr<FailureBook::SceneHistory>> scene_histories_;  // of active frames
};

}  // namespace tessera
