#include "coordinator/core/schedule/scheduler.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/text/unicode.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr Instant kExpiryInterval = milliseconds(250);  // far below any expiry
constexpr Instant kIdleInterval = seconds(1);

}  // namespace

Scheduler::Scheduler(SchedulerOptions options)
    : state_(options.session, options.epoch),
      leases_(state_),
      scenes_(state_),
      failures_(state_, leases_, options.attempts_max),
      trials_(state_, failures_),
      dispatcher_(state_, leases_, scenes_, trials_),
      tail_(state_, leases_),
      votes_(state_, leases_, failures_, options.attempts_max),
      units_(state_, leases_, failures_, votes_),
      sync_(state_, leases_, scenes_, dispatcher_, trials_, votes_),
      is_first_(options.epoch <= 1) {
  state_.awaits_workers = !is_first_;
}

void Scheduler::Advance(Instant now) {
  if (!begun_) begun_ = now;
  state_.awaits_workers = !is_first_ && now - *begun_ < kOtherMachinePatience;
  if (now >= expiry_due_) {
    expiry_due_ = now + kExpiryInterval;
    sync_.Expire(now);
    failures_.FailWhatAllFailed(now);
    trials_.Advance(now);
    votes_.Relax(now);
  }
  trials_.Mark();
  dispatcher_.Preempt(now);
  dispatcher_.Dispatch(now);
  tail_.Relieve(now);
  scenes_.Prefetch(now);
  state_.workers.occupancy().Advance(now, state_.counters);
}

Instant Scheduler::TickInterval() const {
  if (!state_.idle.blocked().empty() && !state_.leases.empty()) return kTailInterval;
  return state_.workers.empty() && state_.jobs.open().empty() ? kIdleInterval : kExpiryInterval;
}

void Scheduler::AddJob(Job& job, const std::set<uint32_t>& finished) {
  job.schedule = {};
  for (uint32_t f = 0; f < job.spec->frames.size(); ++f) {
    if (!finished.contains(f)) job.schedule.ahead.insert(f);
    job.schedule.has_one_scene &= job.spec->frames[f].scene_file == job.spec->frames[0].scene_file;
  }
  state_.jobs.Add(job);
  dispatcher_.AnnounceJob();
}

void Scheduler::ExtendJob(Job& job, std::shared_ptr<const JobSpec> spec) {
  for (uint32_t f = 0; f < spec->frames.size(); ++f) {
    const uint32_t samples = spec->frames[f].spec.samples_per_pixel;
    if (samples == job.spec->frames[f].spec.samples_per_pixel) continue;
    if (const auto active = job.schedule.active.find(f); active != job.schedule.active.end()) {
      active->second.work.Extend(samples);
    } else {
      job.schedule.ahead.insert(f);
    }
  }
  job.spec = std::move(spec);
  state_.idle.UnblockAll();
}

void Scheduler::RemoveJob(Job& job) {
  if (state_.jobs.Find(job.id) == nullptr) return;
  leases_.RevokeAll(state_.leases.OfJob(job.id));
  state_.leases.ForgetJob(job.id);
  state_.losses.ForgetJob(job.id);
  scenes_.StopRequests(job);
  state_.jobs.Remove(job);
  job.schedule = {};
  state_.idle.UnblockAll();  // workers that waited for a scene of this job may load another
}

void Scheduler::DropFrame(Job& job, uint32_t frame) {
  job.schedule.ahead.erase(frame);
  const auto active = job.schedule.active.find(frame);
  if (active == job.schedule.active.end()) return;
  leases_.RevokeAll(state_.leases.OfFrame(job.id, frame));
  state_.leases.ForgetFrame(job.id, frame);
  scenes_.StopRequest(active->second.scene.key);
  job.schedule.active.erase(active);
  state_.jobs.ClearRefusal();
  state_.idle.UnblockAll();  // there is room for another frame, and workers that waited for this one are free
}

void Scheduler::SetPaused(Instant now, Job& job, bool is_paused) {
  if (job.is_paused == is_paused) return;
  state_.jobs.SetPaused(job, is_paused);
  if (!is_paused) {
    dispatcher_.AnnounceJob();
    return;
  }
  scenes_.StopRequests(job);
  state_.idle.UnblockAll();  // workers that waited for units of the job may have a frame of another begun
  for (const LeaseId lease : state_.leases.OfJob(job.id)) {
    if (state_.leases.At(lease).IsWaiting(now)) leases_.Revoke(lease);
  }
}

void Scheduler::SetPriority(Job& job, int priority) {
  if (job.priority == priority) return;
  state_.jobs.SetPriority(job, priority);
  if (job.is_paused) return;
  dispatcher_.AnnounceJob();
}

void Scheduler::Unblock(WorkerRecord& worker) {
  state_.idle.Remove(worker.id);
  leases_.UpdateRoom(worker);
}

void Scheduler::Drain(WorkerId id) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr || !state_.workers.Drain(*worker)) return;
  Unblock(*worker);
  state_.log.push_back(
      fmt::format("worker_drained worker={:016x} name={}", Number(id), LogText(worker->name)));
}

void Scheduler::Release(WorkerId id) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr || !state_.workers.Release(*worker)) return;
  Unblock(*worker);
  state_.log.push_back(
      fmt::format("worker_released worker={:016x} name={}", Number(id), LogText(worker->name)));
}

bool Scheduler::IsTrusted(WorkerId id) const {
  const WorkerRecord* const worker = state_.workers.Find(id);
  return worker == nullptr || !worker->is_quarantined();
}

bool Scheduler::IsConnected(WorkerId id) const {
  const WorkerRecord* const worker = state_.workers.Find(id);
  return worker != nullptr && worker->is_live;
}

bool Scheduler::MayWork(WorkerId id) const {
  const WorkerRecord* const worker = state_.workers.Find(id);
  return worker != nullptr && worker->may_work();
}

std::string Scheduler::NameOf(WorkerId id) const {
  const WorkerRecord* const worker = state_.workers.Find(id);
  return worker != nullptr ? worker->name : "";
}

std::optional<WorkerId> Scheduler::LeastLoaded(const std::set<WorkerId>& excluded) const {
  std::optional<WorkerId> chosen;
  double load_min = 0;
  for (const auto& [id, worker] : state_.workers.all()) {
    if (!worker.may_work() || excluded.contains(id)) continue;
    const double load = static_cast<double>(state_.leases.OfWorker(id).size()) / worker.slots;
    if (chosen && load >= load_min) continue;
    chosen = id;
    load_min = load;
  }
  return chosen;
}

std::map<WorkerId, Party> Scheduler::AbleWorkers() const {
  std::map<WorkerId, Party> able;
  for (const WorkerId id : state_.workers.AbleFor({}))
    able.emplace(id, PartyOf(state_.workers.Find(id)->member, id));
  return able;
}

std::string Scheduler::WhyNoWorker() const {
  return state_.workers.AbleFor({}).empty() ? state_.workers.WhyNoneFor({}) : "";
}

bool Scheduler::IsFull(WorkerId worker) const {
  return state_.workers.is_full() && state_.workers.Find(worker) == nullptr;
}

std::optional<MemberId> Scheduler::MemberOf(WorkerId id) const {
  const WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr || !worker->has_joined) return std::nullopt;
  return worker->member;
}

bool Scheduler::IsComplete(const Job& job, uint32_t frame) const {
  return !job.schedule.active.contains(frame) && !job.schedule.ahead.contains(frame);
}

void Scheduler::CountAccepted(WorkerId id, uint64_t pixel_samples, double render_seconds) {
  ++state_.counters.units_accepted;
  state_.counters.samples_accepted += pixel_samples;
  state_.counters.render_s += render_seconds;
  if (WorkerRecord* const worker = state_.workers.Find(id)) worker->pace.Accept(pixel_samples);
}

std::vector<WorkerStatus> Scheduler::Workers(Instant now) const {
  std::map<Digest, JobId> jobs;  // of one scene the oldest
  for (const auto& [id, job] : state_.jobs.open()) {
    for (const auto& [index, frame] : job->schedule.active) jobs.try_emplace(frame.scene.key, id);
  }
  std::vector<WorkerStatus> all = state_.workers.Statuses(now, state_.leases);
  for (WorkerStatus& status : all) {
    std::set<JobId> scenes;
    for (const auto& [key, is_ready] : state_.workers.Find(status.worker)->scenes) {
      const auto job = jobs.find(key);
      if (is_ready && job != jobs.end()) scenes.insert(job->second);
    }
    for (const JobId job : scenes) {
      if (status.scenes.size() < kScenesShownMax) status.scenes.push_back(job);
    }
  }
  return all;
}

uint32_t Scheduler::WorkersOf(JobId job) const {
  return static_cast<uint32_t>(state_.leases.ShareOf(job).holders.size());
}

std::string Scheduler::Obstacle(JobId id) const {
  const Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return {};
  const std::set<std::string>& tags = job->spec->required_tags;
  if (tags.empty() && state_.workers.total_slots() == 0) return state_.workers.WhyNoneFor(tags);
  const auto& frames = job->schedule.active;
  const bool has_failures = std::any_of(frames.begin(), frames.end(),
                                        [](const auto& each) { return !each.second.failures.empty(); });
  // The common case is cheap.
  if (tags.empty() && job->spec->verify_share <= 0 && !has_failures) return {};
  const std::set<WorkerId> able = state_.workers.AbleFor(tags);
  if (able.empty()) return state_.workers.WhyNoneFor(tags);
  if (const std::string why = trials_.WhyOnTrial(*job); !why.empty()) return why;
  if (const std::string why = FailureHandling::WhyNoneMay(*job, able); !why.empty()) return why;
  size_t stuck = 0;
  for (const auto& [index, frame] : frames) stuck += frame.verification.CountStuck(able);
  if (stuck == 0) return {};
  return fmt::format("{} unit{} to be verified by another worker: connect one more", stuck,
                     stuck == 1 ? " waits" : "s wait");
}

JobPhase Scheduler::PhaseOf(const Job& job) const {
  if (state_.jobs.Find(job.id) == nullptr || job.schedule.is_rendered()) return JobPhase::kRendered;
  return job.schedule.HasOpen() ? JobPhase::kOpen : JobPhase::kTail;
}

}  // namespace tessera
