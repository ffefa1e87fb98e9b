// What follows when workers fail units or scenes or return wrong results: units go to other workers, frames
// whose units no worker can render fail, and workers that fail what others finish go into quarantine. Owned
// by the scheduler.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/schedule/lease_control.h"

namespace tessera {

struct FailedJob {
  JobId job{};
  std::string reason;
};

// A frame of a job that has several.
struct FailedFrame {
  JobId job{};
  uint32_t frame = 0;
  std::string reason;
};

class FailureHandling {
 public:
  FailureHandling(ScheduleState& state, LeaseControl& leases, int attempts_max)
      : state_(state), leases_(leases), attempts_max_(attempts_max) {}

  // The worker could not render the unit. Does nothing unless it holds the lease of that unit.
  void FailUnit(WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& reason);
  // The worker could not load the scene: as if it had failed all of its units, in every job. A limit of the
  // worker rules out the worker and counts for no more; a scene that others have rendered is the worker's
  // fault. Does nothing unless it was told to load it.
  void FailScene(WorkerId worker, const Digest& scene, const std::string& reason, FailureCause cause);
  // The worker returned a wrong result: a failure that also counts against the worker.
  void RefuseResult(WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& reason);
  // The worker has rendered the unit, so those that failed it are at fault.
  void Disprove(WorkerId by, const WorkUnit& unit, ActiveFrame& frame);
  void Quarantine(WorkerRecord& worker, const std::string& reason);
  void FailJob(JobId job, const std::string& reason);
  // Fails frames that every able worker has failed for kPoisonGrace, even if those are fewer than
  // attempts_max, and whatever the cause. A farm with a smaller number than the default has no more workers
  // than that, so it does not wait for another one.
  void FailWhatAllFailed(Instant now);
  // What of the job none of the able workers (not empty) may render, because all of them failed it, and why;
  // empty if there is nothing.
  static std::string WhyNoneMay(const Job& job, const std::set<WorkerId>& able);
  // Since the last call: jobs that no worker can render, such as those of a single frame with a unit that
  // nobody can, and such frames of other jobs. The caller removes them.
  std::vector<FailedJob> TakeFailedJobs() { return std::exchange(failed_, {}); }
  std::vector<FailedFrame> TakeFailedFrames() { return std::exchange(failed_frames_, {}); }

 private:
  bool Hold(WorkerId worker, LeaseId lease, const WorkUnit& unit) const;
  void RecordFailure(WorkerId worker, const WorkUnit& unit, const std::string& reason);
  // Forgets that the worker has the scene or was told to load it, and returns its leases of it.
  void Withdraw(WorkerRecord& worker, const Digest& scene);
  // Fails the frame if what was recorded for it is fatal.
  void Judge(const Job& job, uint32_t index, const ActiveFrame& frame);
  void FailFrame(const Job& job, uint32_t index, const std::string& reason);
  void Strike(WorkerId worker, const std::string& reason);

  ScheduleState& state_;
  LeaseControl& leases_;
  int attempts_max_;
  std::vector<FailedJob> failed_;
  std::vector<FailedFrame> failed_frames_;
};

}  // namespace tessera
