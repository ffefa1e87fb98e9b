// A stage for scheduler tests: a scheduler, a clock that the test moves, and workers that do what the test
// says.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/schedule/policy.h"
#include "coordinator/core/schedule/scheduler.h"
#include "tests/coordinator/core/schedule/former_lease.h"

namespace tessera {

class SchedulerStage {
 public:
  explicit SchedulerStage(SchedulerOptions options = {kLaterEpoch}) : scheduler(options) {}

  // A job of `frames` frames of 64 x 64 pixels in 16 tiles.
  JobId AddJob(uint32_t samples, int priority = 0, int frames = 1) {
    auto spec = std::make_shared<JobSpec>();
    const JobId id{job_next_++};
    spec->submission = Number(id);
    spec->priority = priority;
    spec->package = Sha256(std::to_string(Number(id)));
    spec->required_tags = required_tags;
    spec->verify_share = verify_share;
    spec->first = first;
    for (int f = 0; f < frames; ++f) {
      FrameSpec frame;
      frame.width = frame.height = 64;
      frame.crop = {0, 0, 64, 64};
      frame.tile_size = 16;
      frame.samples_per_pixel = samples;
      spec->frames.push_back({"scene" + std::to_string(f), "", frame, f});
    }
    specs[id] = spec;
    Open(id, spec);
    return id;
  }
  void Open(JobId id, std::shared_ptr<const JobSpec> spec) {
    Job& job = jobs[id];
    job.id = id;
    job.priority = spec->priority;
    job.submitted = job.spec = std::move(spec);
    scheduler.AddJob(job);
  }
  bool IsComplete(JobId job, uint32_t frame) const { return scheduler.IsComplete(jobs.at(job), frame); }
  void SetPaused(JobId job, bool is_paused) { scheduler.SetPaused(now, jobs.at(job), is_paused); }
  void SetPriority(JobId job, int priority) { scheduler.SetPriority(jobs.at(job), priority); }
  void RemoveJob(JobId job) { scheduler.RemoveJob(jobs.at(job)); }
  Digest SceneOf(JobId job, uint32_t frame = 0) const {
    const JobSpec& spec = *specs.at(job);
    return SceneKey(spec.package, spec.frames[frame].scene_file, "", spec.frames[frame].spec);
  }

  // The state that the worker sends next; tests change it before Send.
  WorkerState& Worker(uint64_t id, int slots = 1) {
    const auto [found, is_new] = states.try_emplace(id);
    if (is_new) {
      found->second.worker = WorkerId{id};
      found->second.name = "w" + std::to_string(id);
      found->second.slots = slots;
    }
    return found->second;
  }
  void HaveScene(uint64_t worker, JobId job, uint32_t frame = 0) {
    Worker(worker).scenes.push_back({SceneOf(job, frame), true});
  }
  // A worker with the scenes of all jobs in memory.
  void Join(uint64_t id, int slots = 1) {
    Worker(id, slots);
    for (const auto& [job, spec] : specs) {
      for (uint32_t f = 0; f < spec->frames.size(); ++f) HaveScene(id, job, f);
    }
    Send(id);
  }
  // The worker sends its state with the leases that it holds.
  void Send(uint64_t id) {
    WorkerState& state = Worker(id);
    state.leases.clear();
    ++state.sequence;
    for (const auto& [lease, value] : held[id]) {
      state.leases.push_back({lease, value.unit, LeaseStage::kWaiting, {}});
    }
    scheduler.Synchronize(now, state);
  }
  // Lets time pass, decides, and gives every worker its directive.
  void Advance(Instant duration = {}) {
    now += duration;
    scheduler.Advance(now);
    for (const auto& [id, state] : states) Deliver(id);
  }
  void Deliver(uint64_t id) {
    if (!scheduler.HasNews(WorkerId{id})) return;
    told[id] = scheduler.TakeDirective(now, WorkerId{id});
    for (const Lease& lease : told[id].leases) held[id][lease.id] = lease;
    for (const LeaseId lease : told[id].drop) {
      held[id].erase(lease);
      dropped[id].push_back(lease);
    }
  }
  std::vector<Lease> Held(uint64_t id) {
    std::vector<Lease> leases;
    for (const auto& [lease, value] : held[id]) leases.push_back(value);
    return leases;
  }
  // Leases of the job that any worker holds.
  size_t HeldOf(JobId job) const {
    size_t count = 0;
    for (const auto& [worker, leases] : held) {
      for (const auto& [id, lease] : leases) count += lease.unit.job == job;
    }
    return count;
  }
  bool Finish(uint64_t id, const Lease& lease, double seconds) {
    held[id].erase(lease.id);
    return scheduler.Finish(now, WorkerId{id}, lease.id, lease.unit, seconds);
  }
  void Fail(uint64_t id, const Lease& lease, const std::string& reason) {
    held[id].erase(lease.id);
    scheduler.FailUnit(WorkerId{id}, lease.id, lease.unit, reason);
  }
  void FinishAll(uint64_t id, double seconds_per_sample) {
    for (const Lease& lease : Held(id)) Finish(id, lease, seconds_per_sample * lease.unit.range.size);
  }
  std::string Status(uint64_t id) const {
    for (const WorkerStatus& status : scheduler.Workers(now)) {
      if (status.worker == WorkerId{id}) return status.quarantined ? "quarantined: " + status.reason : "fine";
    }
    return "unknown";
  }

  std::map<JobId, Job> jobs;
  Scheduler scheduler;
  Instant now = std::chrono::hours(1);
  std::set<std::string> required_tags;  // of the jobs added from now on
  double verify_share = 0;              // likewise
  std::optional<Region> first;          // likewise
  std::map<JobId, std::shared_ptr<const JobSpec>> specs;
  std::map<uint64_t, WorkerState> states;
  std::map<uint64_t, std::map<LeaseId, Lease>> held;
  std::map<uint64_t, std::vector<LeaseId>> dropped;
  std::map<uint64_t, WorkerDirective> told;

 private:
  uint64_t job_next_ = 1;
};

}  // namespace tessera
