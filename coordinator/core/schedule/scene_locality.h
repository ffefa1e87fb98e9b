// Which frames of a job are begun, which scene each worker loads, and which files it fetches meanwhile.
// Frames are rendered in order, all workers at one, the next one loaded meanwhile. Where loading takes longer
// than the farm takes to render a frame, frames are divided among the workers, so that not every worker loads
// every scene. Of the jobs after that only the files are fetched: a scene in memory is large, and theirs may
// be hours away. Owned by the scheduler.
#pragma once

#include <map>

#include "coordinator/core/schedule/schedule_state.h"

namespace tessera {

// Work for a worker; no frame: there is none.
struct FrameChoice {
  Job* job = nullptr;
  uint32_t index = 0;
  ActiveFrame* frame = nullptr;
};

class SceneLocality {
 public:
  explicit SceneLocality(ScheduleState& state) : state_(state) {}

  // Begins frames until, besides those to be rendered now, one more has open work: its scene is loaded
  // meanwhile.
  void Activate(Job& job);
  // The first frame with work for the worker whose scene the worker has ready.
  FrameChoice ReadyFrame(Job& job, const WorkerRecord& worker) const;
  // The first frame with work for the worker whose scene it does not have, and that too few others have.
  FrameChoice FrameToLoad(Instant now, Job& job, const WorkerRecord& worker);
  // Tells the worker to load the scene, unless it does so already.
  void Request(WorkerRecord& worker, const FrameChoice& choice);
  // Workers that were told to load a scene of the job's package need not.
  void StopRequests(const Job& job);
  // The same for one scene.
  void StopRequest(const Digest& scene);
  // While a worker renders `current` it loads the next frame, unless it is loading something or has another
  // one ready.
  void RequestNext(Instant now, WorkerRecord& worker, const FrameChoice& current);
  // Workers that render fetch the files of the next jobs. Looks only once per kPrefetchInterval.
  void Prefetch(Instant now);
  // A scene that the worker was told to load is ready.
  void MeasureLoading(Instant now, WorkerRecord& worker, const Digest& scene);

 private:
  uint32_t FramesAbreast(const Job& job) const;
  void CountHolders(Instant now);

  ScheduleState& state_;
  std::map<Digest, size_t> holders_;  // of each scene: workers that have it or load it, as last counted
  Instant holders_due_{}, prefetch_due_{};
};

}  // namespace tessera
