#include "coordinator/core/schedule/scene_locality.h"

#include <algorithm>
#include <cmath>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

bool HasWorkFor(const ActiveFrame& frame, Voter worker) {
  const auto may = [&](uint32_t tile) { return frame.failures.May(worker.worker, tile); };
  const bool has_open = frame.failures.empty() ? frame.work.HasOpen() : frame.work.HasOpen(may);
  return has_open || frame.verification.Find(worker, may);
}

}  // namespace

// How many frames are rendered side by side.
uint32_t SceneLocality::FramesAbreast(const Job& job) const {
  const JobSchedule& schedule = job.schedule;
  const double speed = state_.workers.total_speed();
  if (schedule.load_s <= 0 || schedule.measured_samples <= 0 || speed <= 0) return 1;
  const double frame_samples =
      static_cast<double>(job.spec->frames[0].spec.crop.area()) * job.spec->frames[0].spec.samples_per_pixel;
  const double frame_s = schedule.measured_cost / schedule.measured_samples * frame_samples / speed;
  const double abreast = std::ceil(schedule.load_s / std::max(frame_s, kUnitDurationMin_s));
  const auto most = static_cast<double>(std::clamp<size_t>(state_.workers.size(), 1, kFramesActiveMax - 1));
  return static_cast<uint32_t>(std::clamp(abreast, 1.0, most));
}

void SceneLocality::Activate(Job& job) {
  JobSchedule& schedule = job.schedule;
  if (schedule.ahead.empty() || schedule.active.size() >= kFramesActiveMax) return;
  uint32_t open = 0;
  for (const auto& [index, frame] : schedule.active) open += frame.work.HasOpen() ? 1 : 0;
  const uint32_t wanted = FramesAbreast(job) + 1;
  while (open < wanted && !schedule.ahead.empty() && schedule.active.size() < kFramesActiveMax &&
         state_.jobs.MayBegin(job, *schedule.ahead.begin())) {
    state_.jobs.Begin(job, *schedule.ahead.begin());
    state_.idle.UnblockAll();
    ++open;
  }
}

FrameChoice SceneLocality::ReadyFrame(Job& job, const WorkerRecord& worker) const {
  const Voter voter = state_.VoterOf(worker);
  for (auto& [index, frame] : job.schedule.active) {
    if (worker.has_ready(frame.scene.key) && HasWorkFor(frame, voter)) return {&job, index, &frame};
  }
  return {};
}

FrameChoice SceneLocality::FrameToLoad(Instant now, Job& job, const WorkerRecord& worker) {
  const uint32_t abreast = FramesAbreast(job);
  CountHolders(now);
  const Voter voter = state_.VoterOf(worker);
  const size_t holders_max = (state_.workers.size() + abreast - 1) / abreast;
  FrameChoice any;
  for (auto& [index, frame] : job.schedule.active) {
    const Digest& scene = frame.scene.key;
    if (worker.has_ready(scene) || !HasWorkFor(frame, voter)) continue;
    const FrameChoice choice{&job, index, &frame};
    if (abreast == 1 || worker.scenes.contains(scene)) return choice;
    if (holders_[scene] < holders_max + (worker.wants(scene) ? 1 : 0)) return choice;
    if (any.frame == nullptr) any = choice;
  }
  return any;
}

void SceneLocality::CountHolders(Instant now) {
  if (now < holders_due_) return;
  holders_due_ = now + kTailInterval;
  holders_.clear();
  for (const auto& [id, worker] : state_.workers.all()) {
    if (!worker.may_work()) continue;
    for (const auto& [scene, is_ready] : worker.scenes) ++holders_[scene];
    for (const SceneRequest& scene : worker.wanted)
      holders_[scene.key] += worker.scenes.contains(scene.key) ? 0 : 1;
  }
}

void SceneLocality::Request(WorkerRecord& worker, const FrameChoice& choice) {
  const SceneRequest& scene = choice.frame->scene;
  if (worker.scenes.contains(scene.key) || worker.wants(scene.key)) return;
  for (const SceneRequest& other : worker.wanted) {
    size_t& holders = holders_[other.key];
    if (holders > 0 && !worker.scenes.contains(other.key)) --holders;
  }
  state_.workers.RequestScene(worker, scene);
  ++holders_[scene.key];
}

void SceneLocality::StopRequests(const Job& job) {
  for (auto& [id, worker] : state_.workers.all()) {
    std::erase_if(worker.wanted,
                  [&](const SceneRequest& scene) { return scene.package == job.spec->package; });
  }
}

void SceneLocality::StopRequest(const Digest& scene) {
  for (auto& [id, worker] : state_.workers.all())
    std::erase_if(worker.wanted, [&](const SceneRequest& wanted) { return wanted.key == scene; });
}

void SceneLocality::RequestNext(Instant now, WorkerRecord& worker, const FrameChoice& current) {
  Job& job = *current.job;
  if (job.schedule.active.size() < 2 || worker.is_loading()) return;
  for (const SceneRequest& scene : worker.wanted) {
    if (!worker.scenes.contains(scene.key)) return;  // it was told to load this, or is about to be
  }
  for (const auto& [index, frame] : job.schedule.active) {
    if (index != current.index && frame.work.HasOpen() && worker.has_ready(frame.scene.key)) return;
  }
  if (const FrameChoice next = FrameToLoad(now, job, worker); next.frame != nullptr) Request(worker, next);
}

void SceneLocality::Prefetch(Instant now) {
  if (now < prefetch_due_) return;
  prefetch_due_ = now + kPrefetchInterval;
  const std::vector<Digest> ahead = state_.jobs.PackagesAhead();
  if (ahead.empty()) return;
  for (auto& [id, worker] : state_.workers.all()) {
    const std::vector<LeaseId>& leases = state_.leases.OfWorker(id);
    if (!worker.may_work() || leases.empty()) continue;  // workers without leases are told to load scenes
    std::vector<Digest> packages = ahead;
    std::erase(packages, state_.jobs.At(state_.leases.At(leases.front()).lease.unit.job).spec->package);
    packages.resize(std::min(packages.size(), kScenesAheadMax));
    if (packages != worker.prefetch) state_.workers.RequestPrefetch(worker, std::move(packages));
  }
}

void SceneLocality::MeasureLoading(Instant now, WorkerRecord& worker, const Digest& scene) {
  const auto told = worker.loading_since.find(scene);
  if (told == worker.loading_since.end()) return;
  const double seconds = Seconds(now - told->second);
  worker.loading_since.erase(told);
  for (const auto& [id, job] : state_.jobs.open()) {
    const auto& frames = job->schedule.active;
    const auto is_it = [&](const auto& entry) { return entry.second.scene.key == scene; };
    if (std::none_of(frames.begin(), frames.end(), is_it)) continue;
    double& load_s = job->schedule.load_s;
    load_s = load_s > 0 ? load_s + kLoadGain * (seconds - load_s) : seconds;
  }
}

}  // namespace tessera
