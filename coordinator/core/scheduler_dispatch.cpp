// Who gets which unit.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/policy.h"
#include "coordinator/core/scheduler.h"
#include "renderer/util/check.h"

namespace tessera {

void Scheduler::Advance(Instant now) {
  Expire(now);
  Preempt(now);
  Dispatch(now);
  RelieveTail(now);
  FetchNextJobs(now);
  occupancy_.Advance(now, counters_);
}

double Scheduler::QueueSeconds(const WorkerRecord& worker) const {
  return worker.queue_cost / worker.speed + worker.queue_unknown * kUnknownUnitDuration_s;
}

bool Scheduler::HasRoom(const WorkerRecord& worker) const {
  const int held = static_cast<int>(worker.leases.size());
  if (held < worker.slots * kUnitsPerSlotMin) return true;
  return held < worker.slots * kUnitsPerSlotMax && QueueSeconds(worker) < worker.slots * kPrefetchDuration_s;
}

void Scheduler::UpdateHunger(WorkerRecord& worker) {
  CountSlots(worker);
  if (!worker.MayWork() || !HasRoom(worker)) {
    ForgetHunger(worker);
  } else if (!starved_.contains(worker.id)) {
    hungry_.insert(worker.id);
  }
}

void Scheduler::ForgetHunger(const WorkerRecord& worker) {
  hungry_.erase(worker.id);
  starved_.erase(worker.id);
}

// In rounds, so that no worker has units waiting while another has a slot without one.
void Scheduler::Dispatch(Instant now) {
  for (const int per_slot : {1, kUnitsPerSlotMin, kUnitsPerSlotMax}) {
    for (const WorkerId id : std::vector<WorkerId>(hungry_.begin(), hungry_.end())) {
      WorkerRecord& worker = workers_.at(id);
      const size_t enough = static_cast<size_t>(worker.slots) * static_cast<size_t>(per_slot);
      while (worker.leases.size() < enough && HasRoom(worker)) {
        if (GrantOne(now, worker)) continue;
        hungry_.erase(id);
        starved_.insert(id);
        break;
      }
    }
  }
}

bool Scheduler::GrantOne(Instant now, WorkerRecord& worker) {
  const Choice choice = Choose(now, worker, std::nullopt);
  if (choice.frame == nullptr) return false;
  GrantFrom(now, worker, choice);
  LoadNextFrame(now, worker, choice);
  return true;
}

void Scheduler::GrantFrom(Instant now, WorkerRecord& worker, const Choice& choice) {
  const auto may = [&](uint32_t tile) { return choice.frame->failures.May(worker.id, tile); };
  FrameRecord& frame = *choice.frame;
  auto samples = frame.verification.Find(worker.id, may);
  if (!samples) {
    samples = frame.work.Take(UnitSeconds(*choice.job) * worker.speed, may);
    TESSERA_CHECK(samples.has_value());
    if (frame.verification.IsChosen(*samples)) BeginTrial(frame, *samples);
  }
  const WorkUnit unit{choice.job->id, choice.frame_index, samples->tile, samples->range};
  Grant(now, worker, *choice.job, frame, unit, NextLease());
}

Scheduler::Choice Scheduler::Choose(Instant now, WorkerRecord& worker, std::optional<int> floor) {
  for (const auto& [priority, jobs] : priorities_) {
    if (floor && priority <= *floor) break;
    if (const Choice choice = ChooseOfJobs(now, worker, jobs); choice.frame != nullptr) return choice;
  }
  return {};
}

// Of jobs with equal rights, the one that has the least of the farm's time: first among those whose scene the
// worker has in memory. Time, not units: jobs cut their units to different lengths.
Scheduler::Choice Scheduler::ChooseOfJobs(Instant now, WorkerRecord& worker, const std::set<JobId>& jobs) {
  Choice ready, unready;
  for (const JobId id : jobs) {
    JobRecord& job = jobs_.at(id);
    if (!worker.HasTags(job.spec->required_tags)) continue;
    Activate(job);
    const auto poorer = [&](const Choice& than) {
      return than.job == nullptr || job.leases_s < than.job->leases_s;
    };
    if (const Choice choice = ReadyFrame(job, worker); choice.frame != nullptr) {
      if (poorer(ready)) ready = choice;
    } else if (const Choice other = FrameToLoad(now, job, worker); other.frame != nullptr) {
      if (poorer(unready)) unready = other;
    }
  }
  // A scene is loaded for want of anything else to do, or for a job that has much less than its share.
  const bool unfair =
      unready.job != nullptr && (ready.job == nullptr || unready.job->leases_s * 2 < ready.job->leases_s);
  if (unfair) Want(worker, unready);
  return ready;
}

Scheduler::Choice Scheduler::ReadyFrame(JobRecord& job, const WorkerRecord& worker) {
  for (auto& [index, frame] : job.frames) {
    if (worker.HasReady(frame.scene.key) && MayRender(frame, worker)) return {&job, index, &frame};
  }
  return {};
}

void Scheduler::Want(WorkerRecord& worker, const Choice& choice) {
  const SceneOrder& scene = choice.frame->scene;
  if (worker.scenes.contains(scene.key)) return;  // it is being loaded
  if (worker.Wants(scene.key)) return;
  for (const SceneOrder& other : worker.wanted) {
    size_t& crew = crews_[other.key];
    if (crew > 0 && !worker.scenes.contains(other.key)) --crew;
  }
  worker.wanted = {scene};
  worker.wanted_told = false;
  ++crews_[scene.key];
  news_.insert(worker.id);
}

std::optional<double> Scheduler::OpenCost(const JobRecord& job) const {
  if (!job.frames_ahead.empty()) return std::nullopt;
  double cost = 0;
  for (const auto& [index, frame] : job.frames) {
    const auto open = frame.work.OpenCost();
    if (!open) return std::nullopt;
    cost += *open;
  }
  return cost * (1 + job.spec->verify_share);
}

// How long a unit of the job should take on any slot.
double Scheduler::UnitSeconds(const JobRecord& job) const {
  const double longest = std::max(kUnitDurationMax_s, total_slots_ / kResultsPerSecondMax);
  const double shortest = std::max(kUnitDurationMin_s, total_slots_ / kResultsPerSecondBurst);
  const auto open = OpenCost(job);
  if (!open || total_speed_ <= 0) return longest;
  return std::clamp(*open / total_speed_ / kGuidedDivisor, shortest, longest);
}

LeaseRecord& Scheduler::Grant(Instant now, WorkerRecord& worker, JobRecord& job, FrameRecord& frame,
                              const WorkUnit& unit, LeaseId id) {
  LeaseRecord& record = leases_[id];
  const auto duration = std::chrono::duration_cast<std::chrono::milliseconds>(kLeaseDuration);
  record.lease = {id, unit, Bounds(unit), frame.work.Pixels(unit.tile), frame.scene.key, duration};
  record.worker = worker.id;
  record.cost = frame.work.Cost({unit.tile, unit.range});
  record.granted = now;
  record.deadline = now + kLeaseUnlistedMax;
  const bool starts_now = worker.leases.size() < static_cast<size_t>(worker.slots);
  if (starts_now) worker.begun = std::max(worker.begun, id);
  record.expected_start = starts_now ? now : now + FromSeconds(QueueSeconds(worker) / worker.slots);
  record.duration_s = record.cost ? *record.cost / worker.speed : kUnknownUnitDuration_s;
  record.expected_end = record.expected_start + FromSeconds(record.duration_s);
  if (record.cost) {
    worker.queue_cost += *record.cost;
  } else {
    ++worker.queue_unknown;
  }
  worker.leases.insert(id);
  worker.unannounced.push_back(id);
  news_.insert(worker.id);
  ++counters_.leases_granted;
  frame.leases[unit.tile][id] = unit.range;
  frame.verification.Hold({unit.tile, unit.range}, worker.id);
  ++job.leases;
  ++job.holders[worker.id];
  job.leases_s += record.duration_s;
  UpdateHunger(worker);
  return record;
}

// The lease ends; its unit stays as it is.
void Scheduler::Forget(LeaseId id) {
  const auto found = leases_.find(id);
  TESSERA_CHECK(found != leases_.end());
  const LeaseRecord& record = found->second;
  WorkerRecord& worker = workers_.at(record.worker);
  worker.leases.erase(id);
  std::erase(worker.unannounced, id);
  worker.queue_cost = worker.leases.empty() ? 0 : std::max(0.0, worker.queue_cost - record.cost.value_or(0));
  if (!record.cost) --worker.queue_unknown;
  const WorkUnit unit = record.lease.unit;
  JobRecord& job = jobs_.at(unit.job);
  --job.leases;
  if (--job.holders.at(worker.id) == 0) job.holders.erase(worker.id);
  job.leases_s = job.leases == 0 ? 0 : std::max(0.0, job.leases_s - record.duration_s);
  FrameRecord& frame = job.frames.at(unit.frame);
  frame.verification.Release({unit.tile, unit.range}, worker.id);
  auto& of_tile = frame.leases.at(unit.tile);
  of_tile.erase(id);
  if (of_tile.empty()) frame.leases.erase(unit.tile);
  leases_.erase(found);
  UpdateHunger(worker);
}

// The lease ends and its unit is open again; one on trial stays whole as long as anybody knows it.
void Scheduler::Return(LeaseId id) {
  const WorkUnit unit = leases_.at(id).lease.unit;
  ++counters_.leases_retried;
  CountGivenUp(leases_.at(id));
  const TileSamples samples{unit.tile, unit.range};
  Forget(id);
  AnnounceWork();
  FrameRecord& frame = jobs_.at(unit.job).frames.at(unit.frame);
  if (frame.verification.IsOnTrial(samples) && !frame.verification.Abandon(samples)) return;
  GiveBack(frame, samples);
}

void Scheduler::GiveBack(FrameRecord& frame, TileSamples samples) {
  std::vector<SampleRange> held = frame.verification.TrialsOf(samples.tile);
  if (const auto others = frame.leases.find(samples.tile); others != frame.leases.end()) {
    for (const auto& [other, range] : others->second) held.push_back(range);
  }
  frame.work.GiveBack(samples, held);
}

uint32_t Scheduler::WorkersOf(JobId id) const {
  const auto job = jobs_.find(id);
  return job == jobs_.end() ? 0 : static_cast<uint32_t>(job->second.holders.size());
}

}  // namespace tessera
