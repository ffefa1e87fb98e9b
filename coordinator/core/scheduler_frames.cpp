// Which frames of a job are begun, and which of them a worker loads. Frames are rendered in order, all
// workers at one, the next one loaded meanwhile; where loading takes longer than the farm takes to render a
// frame, they are divided among the workers, so that not everybody loads everything.
#include <algorithm>
#include <cmath>

#include "coordinator/core/policy.h"
#include "coordinator/core/scheduler.h"

namespace tessera {

// How many frames are rendered side by side.
uint32_t Scheduler::FramesAbreast(const JobRecord& job) const {
  if (job.load_s <= 0 || job.measured_samples <= 0 || total_speed_ <= 0) return 1;
  const double frame_samples =
      static_cast<double>(job.spec->frames[0].spec.crop.area()) * job.spec->frames[0].spec.samples_per_pixel;
  const double frame_s = job.measured_cost / job.measured_samples * frame_samples / total_speed_;
  const double abreast = std::ceil(job.load_s / std::max(frame_s, kUnitDurationMin_s));
  const auto most = static_cast<double>(std::clamp<size_t>(workers_.size(), 1, kFramesActiveMax - 1));
  return static_cast<uint32_t>(std::clamp(abreast, 1.0, most));
}

// Begins frames until, besides those to be worked at, one more has open work: its scene is loaded meanwhile.
void Scheduler::Activate(JobRecord& job) {
  if (job.frames_ahead.empty() || job.frames.size() >= kFramesActiveMax) return;
  uint32_t open = 0;
  for (const auto& [index, frame] : job.frames) open += frame.work.HasOpen() ? 1 : 0;
  for (const uint32_t wanted = FramesAbreast(job) + 1;
       open < wanted && !job.frames_ahead.empty() && job.frames.size() < kFramesActiveMax; ++open) {
    job.Begin(*job.frames_ahead.begin());
    AnnounceWork();
  }
}

// The first frame with work for the worker whose scene it has not got, and that not enough others have.
Scheduler::Choice Scheduler::FrameToLoad(Instant now, JobRecord& job, const WorkerRecord& worker) {
  const uint32_t abreast = FramesAbreast(job);
  CountCrews(now);
  const size_t crew_max = (workers_.size() + abreast - 1) / abreast;
  Choice any;
  for (auto& [index, frame] : job.frames) {
    if (worker.HasReady(frame.scene.key) || !MayRender(frame, worker)) continue;
    const Choice choice{&job, index, &frame};
    if (abreast == 1 || worker.scenes.contains(frame.scene.key)) return choice;
    if (crews_[frame.scene.key] < crew_max + (worker.Wants(frame.scene.key) ? 1 : 0)) return choice;
    if (any.frame == nullptr) any = choice;
  }
  return any;
}

bool Scheduler::MayRender(const FrameRecord& frame, const WorkerRecord& worker) const {
  const auto may = [&](uint32_t tile) { return frame.failures.May(worker.id, tile); };
  const bool has_open =
      frame.work.HasOpen() &&
      (frame.failures.empty() ? !frame.failures.HasFailedScene(worker.id) : frame.work.HasOpen(may));
  return has_open || frame.verification.Find(worker.id, may);
}

// How many workers have each scene or are loading it.
void Scheduler::CountCrews(Instant now) {
  if (now < crews_due_) return;
  crews_due_ = now + kTailInterval;
  crews_.clear();
  for (const auto& [id, worker] : workers_) {
    if (!worker.MayWork()) continue;
    for (const auto& [scene, is_ready] : worker.scenes) ++crews_[scene];
    for (const SceneOrder& scene : worker.wanted)
      crews_[scene.key] += worker.scenes.contains(scene.key) ? 0 : 1;
  }
}

// A scene that the worker was told to load is ready.
void Scheduler::MeasureLoading(Instant now, WorkerRecord& worker, const Digest& scene) {
  const auto told = worker.loading_since.find(scene);
  if (told == worker.loading_since.end()) return;
  const double seconds = Seconds(now - told->second);
  worker.loading_since.erase(told);
  for (auto& [id, job] : jobs_) {
    const auto is_it = [&](const auto& entry) { return entry.second.scene.key == scene; };
    if (std::none_of(job.frames.begin(), job.frames.end(), is_it)) continue;
    job.load_s = job.load_s > 0 ? job.load_s + kLoadGain * (seconds - job.load_s) : seconds;
  }
}

}  // namespace tessera
