// What workers get ready while they render. The next frame of a job is loaded: it is needed within seconds,
// and shares most of its memory with the one that is rendered. Of the jobs after that the files are fetched,
// no more: a scene in memory is large, and theirs may be hours away.
#include <algorithm>

#include "coordinator/core/policy.h"
#include "coordinator/core/scheduler.h"

namespace tessera {

// While a worker works at a frame it loads the next one, unless it is loading something or has another to go
// on with.
void Scheduler::LoadNextFrame(Instant now, WorkerRecord& worker, const Choice& current) {
  JobRecord& job = *current.job;
  if (job.frames.size() < 2) return;
  for (const auto& [scene, is_ready] : worker.scenes) {
    if (!is_ready) return;
  }
  for (const SceneOrder& scene : worker.wanted) {
    if (!worker.scenes.contains(scene.key)) return;  // told, or about to be
  }
  for (const auto& [index, frame] : job.frames) {
    if (index != current.frame_index && frame.work.HasOpen() && worker.HasReady(frame.scene.key)) return;
  }
  if (const Choice next = FrameToLoad(now, job, worker); next.frame != nullptr) Want(worker, next);
}

// Packages of jobs with open work, in the order in which workers will come to them.
std::vector<Digest> Scheduler::PackagesAhead() const {
  std::vector<Digest> ahead;
  for (const auto& [priority, jobs] : priorities_) {
    for (const JobId id : jobs) {
      const JobRecord& job = jobs_.at(id);
      const Digest& package = job.spec->package;
      if (ahead.size() > kScenesAheadMax) return ahead;
      // A worker needs of a package of many scenes what its frames need, nobody knows which.
      if (!job.has_one_scene || !job.HasOpen()) continue;
      if (std::find(ahead.begin(), ahead.end(), package) == ahead.end()) ahead.push_back(package);
    }
  }
  return ahead;
}

void Scheduler::FetchNextJobs(Instant now) {
  if (now < prefetch_due_) return;
  prefetch_due_ = now + kPrefetchInterval;
  const std::vector<Digest> ahead = PackagesAhead();
  if (ahead.empty()) return;
  for (auto& [id, worker] : workers_) {
    if (!worker.MayWork() || worker.leases.empty()) continue;  // the idle are told to load
    std::vector<Digest> wish = ahead;
    std::erase(wish, jobs_.at(leases_.at(*worker.leases.begin()).lease.unit.job).spec->package);
    wish.resize(std::min(wish.size(), kScenesAheadMax));
    if (wish == worker.prefetch) continue;
    worker.prefetch = std::move(wish);
    worker.prefetch_told = worker.prefetch.empty();
    if (!worker.prefetch_told) news_.insert(id);
  }
}

}  // namespace tessera
