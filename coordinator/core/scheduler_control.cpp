// What people ask for while jobs run: pauses, other priorities, workers to be spared or taken back.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "coordinator/core/policy.h"
#include "coordinator/core/scheduler.h"

namespace tessera {
namespace {

// Why those who are connected and have the tags take no work, counted; empty if there are none.
std::string WhyIdle(const std::map<WorkerId, WorkerRecord>& workers, const std::set<std::string>& tags) {
  size_t drained = 0, quarantined = 0, leaving = 0;
  for (const auto& [id, worker] : workers) {
    if (!worker.live || !worker.HasTags(tags)) continue;
    ++(worker.quarantined() ? quarantined : worker.drained ? drained : leaving);
  }
  std::string why;
  for (const auto& [count, what] : {std::pair(drained, "drained"), std::pair(quarantined, "quarantined"),
                                    std::pair(leaving, "about to leave")}) {
    if (count > 0) why += fmt::format("{}{} {}", why.empty() ? "" : ", ", count, what);
  }
  return why;
}

// Why nobody works at all.
std::string NobodyWorks(const std::map<WorkerId, WorkerRecord>& workers) {
  const std::string why = WhyIdle(workers, {});
  return why.empty() ? "no worker is connected" : "no worker takes work: " + why;
}

}  // namespace

// From now on workers are given to the job.
void Scheduler::Enlist(JobRecord& job) {
  priorities_[job.priority].insert(job.id);
  for (const auto& [id, worker] : workers_) {
    if (!worker.leases.empty()) preempt_.insert(id);
  }
  AnnounceWork();
}

void Scheduler::Delist(JobRecord& job) {
  const auto equals = priorities_.find(job.priority);
  if (equals == priorities_.end()) return;
  equals->second.erase(job.id);
  if (equals->second.empty()) priorities_.erase(equals);
}

void Scheduler::StopWanting(const JobRecord& job) {
  for (auto& [id, worker] : workers_) {
    std::erase_if(worker.wanted, [&](const SceneOrder& scene) { return scene.package == job.spec->package; });
  }
}

std::vector<LeaseId> Scheduler::LeasesOf(const JobRecord& job) const {
  std::vector<LeaseId> all;
  for (const auto& [index, frame] : job.frames) {
    for (const auto& [tile, leases] : frame.leases) {
      for (const auto& [lease, range] : leases) all.push_back(lease);
    }
  }
  return all;
}

// The holder is told to forget it; its unit is open again.
void Scheduler::TakeBack(LeaseId id) {
  Revoke(workers_.at(leases_.at(id).worker), id);
  Return(id);
}

// What its holder has not even heard of waits for sure.
bool Scheduler::IsWaiting(Instant now, const LeaseRecord& record) {
  return !record.announced || !HasStarted(now, record);
}

void Scheduler::SetPaused(Instant now, JobId id, bool paused) {
  JobRecord* const job = FindJob(id);
  if (job == nullptr || job->paused == paused) return;
  job->paused = paused;
  if (!paused) return Enlist(*job);
  Delist(*job);
  StopWanting(*job);
  for (const LeaseId lease : LeasesOf(*job)) {
    if (IsWaiting(now, leases_.at(lease))) TakeBack(lease);
  }
}

void Scheduler::SetPriority(JobId id, int priority) {
  JobRecord* const job = FindJob(id);
  if (job == nullptr || job->priority == priority) return;
  Delist(*job);
  job->priority = priority;
  if (!job->paused) Enlist(*job);
}

// Units that wait at a worker give way to more urgent ones, one for one.
void Scheduler::Preempt(Instant now) {
  const std::set<WorkerId> affected = std::exchange(preempt_, {});
  if (priorities_.size() < 2) return;
  for (const WorkerId id : affected) {
    WorkerRecord* const worker = FindWorker(id);
    if (worker != nullptr && worker->MayWork()) PreemptAt(now, *worker);
  }
}

void Scheduler::PreemptAt(Instant now, WorkerRecord& worker) {
  while (const auto victim = LeastUrgentWaiting(now, worker)) {
    const Choice choice = Choose(now, worker, jobs_.at(leases_.at(*victim).lease.unit.job).priority);
    if (choice.frame == nullptr) return;
    TakeBack(*victim);
    GrantFrom(now, worker, choice);
  }
}

// The youngest lease of the lowest priority.
std::optional<LeaseId> Scheduler::LeastUrgentWaiting(Instant now, const WorkerRecord& worker) const {
  std::optional<LeaseId> least;
  int lowest = 0;
  for (const LeaseId id : worker.leases) {
    const LeaseRecord& record = leases_.at(id);
    if (!IsWaiting(now, record)) continue;
    const int priority = jobs_.at(record.lease.unit.job).priority;
    if (least && priority > lowest) continue;
    least = id;
    lowest = priority;
  }
  return least;
}

// The worker was barred from work or is so no longer.
void Scheduler::NoteBar(WorkerRecord& worker) {
  bars_.push_back({worker.id, worker.name, worker.drained, worker.quarantine});
  worker.notice_told = false;
  news_.insert(worker.id);
  CountSpeed(worker);
  ForgetHunger(worker);
  UpdateHunger(worker);
}

void Scheduler::Drain(WorkerId id) {
  WorkerRecord* const worker = FindWorker(id);
  if (worker == nullptr || worker->drained) return;
  worker->drained = true;
  worker->wanted.clear();
  NoteBar(*worker);
  Log(fmt::format("worker_drained worker={:016x} name=\"{}\"", Number(id), worker->name));
}

void Scheduler::Release(WorkerId id) {
  WorkerRecord* const worker = FindWorker(id);
  if (worker == nullptr || !worker->is_barred()) return;
  worker->drained = false;
  worker->quarantine.clear();
  worker->strikes = 0;
  NoteBar(*worker);
  Log(fmt::format("worker_released worker={:016x} name=\"{}\"", Number(id), worker->name));
}

std::vector<Scheduler::Bar> Scheduler::Bars() const {
  std::vector<Bar> bars;
  for (const auto& [id, worker] : workers_) {
    if (worker.is_barred()) bars.push_back({id, worker.name, worker.drained, worker.quarantine});
  }
  return bars;
}

void Scheduler::RestoreBar(Instant now, const Bar& bar) {
  if (IsFull(bar.worker)) return;
  WorkerRecord& worker = workers_[bar.worker];
  worker.id = bar.worker;
  worker.name = bar.name;
  worker.drained = bar.drained;
  worker.quarantine = bar.quarantine;
  worker.last_contact = now;
}

// Those that may work for the job.
std::set<WorkerId> Scheduler::AbleFor(const JobRecord& job) const {
  std::set<WorkerId> able;
  for (const auto& [id, worker] : workers_) {
    if (worker.MayWork() && worker.HasTags(job.spec->required_tags)) able.insert(id);
  }
  return able;
}

// Why nobody may work for the job, that requires tags.
std::string Scheduler::MissingTags(const JobRecord& job) const {
  const std::set<std::string>& tags = job.spec->required_tags;
  const std::string all = fmt::format("{}", fmt::join(tags, ", "));
  if (const std::string why = WhyIdle(workers_, tags); !why.empty())
    return fmt::format("no worker with tag{} {} takes work: {}", tags.size() == 1 ? "" : "s", all, why);
  std::set<std::string> missing = tags;
  for (const auto& [id, worker] : workers_) {
    if (!worker.live) continue;
    for (const std::string& tag : worker.tags) missing.erase(tag);
  }
  if (!missing.empty()) return fmt::format("no worker has tag {}", *missing.begin());
  return fmt::format("no worker has all of the tags {}", all);
}

std::string Scheduler::Obstacle(JobId id) const {
  const auto found = jobs_.find(id);
  if (found == jobs_.end()) return {};
  const JobRecord& job = found->second;
  if (total_slots_ == 0 && job.spec->required_tags.empty()) return NobodyWorks(workers_);
  if (job.spec->required_tags.empty() && job.spec->verify_share <= 0) return {};  // the common case is cheap
  const std::set<WorkerId> able = AbleFor(job);
  if (able.empty()) return MissingTags(job);
  size_t stuck = 0;
  for (const auto& [index, frame] : job.frames) stuck += frame.verification.CountStuck(able);
  if (stuck == 0) return {};
  return fmt::format("{} unit{} to be verified by another worker than those there are", stuck,
                     stuck == 1 ? " is" : "s are");
}

}  // namespace tessera
