// Events of jobs and units. Workers' events: scheduler_workers.cpp; decisions: scheduler_dispatch.cpp.
#include "coordinator/core/scheduler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coordinator/core/policy.h"
#include "renderer/film/adaptive.h"
#include "renderer/util/check.h"

namespace tessera {

Scheduler::Scheduler(SchedulerOptions options) : options_(options) {}
Scheduler::~Scheduler() = default;

WorkerRecord* Scheduler::FindWorker(WorkerId id) {
  const auto found = workers_.find(id);
  return found == workers_.end() ? nullptr : &found->second;
}

JobRecord* Scheduler::FindJob(JobId id) {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second;
}

FrameRecord* Scheduler::FindFrame(const WorkUnit& unit) {
  JobRecord* const job = FindJob(unit.job);
  if (job == nullptr) return nullptr;
  // A result of a former process's lease begins the frame.
  if (job->frames_ahead.contains(unit.frame)) return &job->Begin(unit.frame);
  const auto found = job->frames.find(unit.frame);
  return found == job->frames.end() ? nullptr : &found->second;
}

void Scheduler::AddJob(JobId id, std::shared_ptr<const JobSpec> spec,
                       const std::set<uint32_t>& finished_frames, std::shared_ptr<const JobSpec> extended,
                       const std::map<uint32_t, uint32_t>& kept) {
  TESSERA_CHECK(!jobs_.contains(id));
  JobRecord& job = jobs_[id];
  job.id = id;
  job.priority = spec->priority;
  for (uint32_t f = 0; f < spec->frames.size(); ++f) {
    if (!finished_frames.contains(f)) job.frames_ahead.insert(f);
    job.has_one_scene &= spec->frames[f].scene_file == spec->frames[0].scene_file;
  }
  job.spec = extended != nullptr ? std::move(extended) : spec;
  job.submitted = std::move(spec);
  job.kept = kept;
  Enlist(job);
}

void Scheduler::ExtendJob(JobId id, std::shared_ptr<const JobSpec> spec,
                          const std::map<uint32_t, uint32_t>& kept) {
  JobRecord& job = *FindJob(id);
  for (uint32_t f = 0; f < spec->frames.size(); ++f) {
    const uint32_t samples = spec->frames[f].spec.samples_per_pixel;
    if (samples == job.spec->frames[f].spec.samples_per_pixel) continue;
    if (const auto active = job.frames.find(f); active != job.frames.end()) {
      active->second.work.Extend(samples);
    } else {
      job.frames_ahead.insert(f);
    }
  }
  job.kept.insert(kept.begin(), kept.end());
  job.spec = std::move(spec);
  AnnounceWork();
}

void Scheduler::RestoreDone(JobId id, uint32_t frame_index, TileSamples samples) {
  FrameRecord* const frame = FindFrame({id, frame_index, samples.tile, samples.range});
  if (frame == nullptr) return;
  frame->work.Finish(samples);
  if (frame->work.Complete()) FindJob(id)->frames.erase(frame_index);
}

void Scheduler::RemoveJob(JobId id) {
  JobRecord* const job = FindJob(id);
  if (job == nullptr) return;
  for (const LeaseId lease : LeasesOf(*job)) {
    CountGivenUp(leases_.at(lease));
    Revoke(workers_.at(leases_.at(lease).worker), lease);
    Forget(lease);
  }
  StopWanting(*job);
  Delist(*job);
  jobs_.erase(id);
  AnnounceWork();  // who wanted a scene of this job may want another
}

bool Scheduler::IsKnown(const WorkUnit& unit) const {
  const auto job = jobs_.find(unit.job);
  if (job == jobs_.end()) return false;
  const JobRecord& record = job->second;
  if (!record.frames.contains(unit.frame) && !record.frames_ahead.contains(unit.frame)) return false;
  const FrameSpec& spec = record.spec->frames[unit.frame].spec;
  return IsUnitRange(spec, unit.range) && unit.tile < static_cast<uint32_t>(spec.TileCount());
}

PixelBounds Scheduler::Bounds(const WorkUnit& unit) const {
  return jobs_.at(unit.job).spec->frames[unit.frame].spec.TileBounds(static_cast<int>(unit.tile));
}

bool Scheduler::IsComplete(JobId id, uint32_t frame) const {
  const auto job = jobs_.find(id);
  TESSERA_CHECK(job != jobs_.end());
  return !job->second.frames.contains(frame) && !job->second.frames_ahead.contains(frame);
}

bool Scheduler::Finish(Instant now, WorkerId worker_id, LeaseId lease, const WorkUnit& unit,
                       double render_seconds) {
  TESSERA_CHECK(IsKnown(unit));
  FrameRecord& frame = *FindFrame(unit);
  EndLease(now, worker_id, lease, unit);
  if (!frame.work.Finish({unit.tile, unit.range})) return false;
  if (WorkerRecord* const worker = FindWorker(worker_id)) Credit(*worker, frame, unit, render_seconds);
  if (!frame.failures.empty()) {
    const auto is_done = [&](TileSamples samples) { return frame.work.IsDone(samples); };
    for (const WorkerId at_fault : frame.failures.Disprove(unit.tile, worker_id, is_done)) {
      Strike(now, at_fault, "failed units that others finished");
    }
  }
  DropMoot(unit.tile, frame);
  Retire(unit.job, unit.frame);
  return true;
}

// The worker has done what the lease asked for.
void Scheduler::EndLease(Instant now, WorkerId worker_id, LeaseId lease, const WorkUnit& unit) {
  const auto held = leases_.find(lease);
  const bool is_holder =
      held != leases_.end() && held->second.worker == worker_id && held->second.lease.unit == unit;
  if (is_holder) Forget(lease);
  WorkerRecord* const worker = FindWorker(worker_id);
  if (worker == nullptr) return;
  worker->last_contact = now;
  // The slot that became free takes up the first unit that waits.
  for (auto next = worker->leases.upper_bound(worker->begun); next != worker->leases.end(); ++next) {
    LeaseRecord& record = leases_.at(*next);
    worker->begun = *next;
    if (record.started || record.expected_start <= now) continue;
    record.expected_end = now + (record.expected_end - record.expected_start);
    record.expected_start = now;
    break;
  }
}

void Scheduler::Credit(WorkerRecord& worker, FrameRecord& frame, const WorkUnit& unit,
                       double render_seconds) {
  ++worker.units_finished;
  if (++worker.units_since_strike >= kForgivenessUnits) worker.strikes = 0;
  if (render_seconds > 0) MeasureSpeed(worker, frame, unit, render_seconds);
}

void Scheduler::SetGoal(JobId id, uint32_t index, uint32_t tile, const TileGoal& goal) {
  JobRecord* const job = FindJob(id);
  if (job == nullptr || !job->frames.contains(index)) return;
  FrameRecord& frame = job->frames.at(index);
  if (frame.work.SetGoal(tile, goal)) AnnounceWork();
  if (!goal.is_final) return;
  DropMoot(tile, frame);
  Retire(id, index);
}

// The frame is forgotten if it is complete.
void Scheduler::Retire(JobId id, uint32_t index) {
  JobRecord& job = *FindJob(id);
  if (!job.frames.at(index).work.Complete()) return;
  job.frames.erase(index);
  if (!job.frames_ahead.empty()) AnnounceWork();  // there is room for another
}

// Leases of the tile whose samples are all done by now are void.
void Scheduler::DropMoot(uint32_t tile, FrameRecord& frame) {
  const auto leases = frame.leases.find(tile);
  if (leases == frame.leases.end()) return;
  std::vector<LeaseId> moot;
  for (const auto& [lease, range] : leases->second) {
    if (frame.work.IsDone({tile, range})) moot.push_back(lease);
  }
  for (const LeaseId lease : moot) {
    ++counters_.leases_moot;
    CountGivenUp(leases_.at(lease));
    Drop(workers_.at(leases_.at(lease).worker), lease);
    Forget(lease);
  }
}

void Scheduler::MeasureSpeed(WorkerRecord& worker, FrameRecord& frame, const WorkUnit& unit,
                             double render_seconds) {
  const TileSamples samples{unit.tile, unit.range};
  if (const auto cost = frame.work.Cost(samples); cost && *cost > 0) {
    const double observed = *cost / render_seconds;
    const double first = 1.0 / static_cast<double>(worker.speed_measurements + 1);
    double gain = std::max(kSpeedGain, first) * std::min(1.0, render_seconds / kSpeedUnitDuration_s);
    // A tile that was never measured may differ from the average for its own reasons.
    if (!frame.work.IsMeasured(unit.tile)) gain /= 4;
    worker.speed = std::clamp(worker.speed * std::pow(observed / worker.speed, gain), kSpeedMin, kSpeedMax);
    ++worker.speed_measurements;
    CountSpeed(worker);
  }
  frame.work.RecordCost(samples, render_seconds * worker.speed);
  JobRecord& job = jobs_.at(unit.job);
  job.measured_cost += render_seconds * worker.speed;
  job.measured_samples += static_cast<double>(frame.work.PixelCount(unit.tile)) * unit.range.size;
}

void Scheduler::FailUnit(Instant now, WorkerId worker_id, LeaseId lease, const WorkUnit& unit,
                         const std::string& words) {
  const auto held = leases_.find(lease);
  if (held != leases_.end() && held->second.worker == worker_id) Return(lease);
  WorkerRecord* const worker = FindWorker(worker_id);
  if (worker == nullptr || !IsKnown(unit)) return;
  FrameRecord& frame = *FindFrame(unit);
  const TileSamples samples{unit.tile, unit.range};
  if (frame.work.IsDone(samples)) return;
  ++worker->units_failed;
  ++counters_.units_failed;
  Log(fmt::format("unit_failed worker={:016x} name=\"{}\" unit=\"{}\" reason=\"{}\"", Number(worker_id),
                  worker->name, unit.Text(), words));
  frame.failures.Record({samples, worker_id, worker->name + ": " + words, now});
  if (const auto condemned = frame.failures.Condemned(options_.attempts_max))
    Condemn(*FindJob(unit.job), *condemned);
}

void Scheduler::FailScene(Instant now, WorkerId worker_id, const Digest& scene, const std::string& words) {
  WorkerRecord* const worker = FindWorker(worker_id);
  if (worker == nullptr) return;
  worker->scenes.erase(scene);
  std::erase_if(worker->wanted, [&](const SceneOrder& order) { return order.key == scene; });
  worker->loading_since.erase(scene);
  ForgetHunger(*worker);
  Log(fmt::format("scene_failed worker={:016x} name=\"{}\" scene={} reason=\"{}\"", Number(worker_id),
                  worker->name, scene.Hex(), words));
  for (const LeaseId lease : std::vector<LeaseId>(worker->leases.begin(), worker->leases.end())) {
    if (leases_.at(lease).lease.scene == scene) Return(lease);
  }
  for (auto& [job_id, job] : jobs_) {
    for (auto& [index, frame] : job.frames) {
      if (frame.scene.key != scene) continue;
      ++worker->units_failed;
      frame.failures.Record({std::nullopt, worker_id, worker->name + ": " + words, now});
      if (const auto condemned = frame.failures.Condemned(options_.attempts_max)) Condemn(job, *condemned);
    }
  }
  UpdateHunger(*worker);
}

void Scheduler::RefuseResult(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                             const std::string& words) {
  FailUnit(now, worker, lease, unit, words);
  Strike(now, worker, "returned wrong results: " + words);
}

void Scheduler::Strike(Instant, WorkerId worker_id, const std::string& reason) {
  WorkerRecord* const worker = FindWorker(worker_id);
  if (worker == nullptr || worker->quarantined()) return;
  worker->units_since_strike = 0;
  if (++worker->strikes < kStrikesMax) return;
  Quarantine(*worker, reason);
}

void Scheduler::Quarantine(WorkerRecord& worker, const std::string& reason) {
  worker.quarantine = reason;
  worker.wanted.clear();
  NoteBar(worker);
  Log(fmt::format("worker_quarantined worker={:016x} name=\"{}\" reason=\"{}\"", Number(worker.id),
                  worker.name, reason));
  for (const LeaseId lease : std::vector<LeaseId>(worker.leases.begin(), worker.leases.end())) {
    Drop(worker, lease);
    Return(lease);
  }
}

void Scheduler::Condemn(JobRecord& job, const std::string& words) {
  const bool known = std::any_of(condemned_.begin(), condemned_.end(),
                                 [&](const CondemnedJob& each) { return each.job == job.id; });
  if (!known) condemned_.push_back({job.id, "a unit cannot be rendered: " + words});
}

void Scheduler::CondemnWhatAllFailed(Instant now) {
  if (now < kPoisonGrace) return;
  for (auto& [id, job] : jobs_) {
    std::set<WorkerId> able;  // filled for the few jobs that have failures
    for (const auto& [index, frame] : job.frames) {
      if (frame.failures.empty()) continue;
      if (able.empty()) able = AbleFor(job);
      if (able.empty()) break;  // whoever comes may do it
      if (const auto words = frame.failures.CondemnedByAll(able, now - kPoisonGrace)) Condemn(job, *words);
    }
  }
}

std::vector<Scheduler::CondemnedJob> Scheduler::TakeCondemned() {
  return std::exchange(condemned_, {});
}

std::vector<std::string> Scheduler::TakeLog() {
  return std::exchange(log_, {});
}

}  // namespace tessera
