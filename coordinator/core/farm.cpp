#include "coordinator/core/farm.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/admission.h"
#include "coordinator/core/fact_message.h"
#include "coordinator/core/job_report.h"
#include "coordinator/core/schedule/policy.h"
#include "renderer/text/unicode.h"
#include "renderer/util/check.h"

namespace tessera {

Farm::Farm(SchedulerOptions options, uint64_t kept_bytes_max, FarmId id)
    : state_(options, kept_bytes_max, id),
      end_(state_),
      frames_(state_, end_),
      results_(state_, frames_),
      extension_(state_),
      preparations_(state_, end_, options.attempts_max),
      recovery_(state_, end_, frames_, extension_) {
  state_.output.facts.emplace_back(CoordinatorStarted{options.epoch, id});
}

void Farm::Advance(Instant now) {
  Scheduler& scheduler = state_.scheduler;
  scheduler.Advance(now);
  for (const WorkerBlock& block : scheduler.TakeBlocks()) state_.output.facts.emplace_back(FactOf(block));
  results_.NoteSuspects();
  preparations_.Advance(now);
  EndFailed(now);
  CountGivenUp(state_);
  MeasureProgress(state_, now);
  end_.ForgetOldest();
  frames_.Advance(now);
  // Results first: their answers carry what is new for a busy worker, and its waiting call need not be woken.
  AnswerResults(now);
  AnswerParked(now);
  for (std::string& line : scheduler.TakeLog()) Log(std::move(line));
  for (JobMessage& message : scheduler.TakeMessages()) state_.output.messages.push_back(std::move(message));
}

void Farm::EndFailed(Instant now) {
  Scheduler& scheduler = state_.scheduler;
  const auto jobs = scheduler.TakeFailedJobs();
  for (const FailedJob& each : jobs) {
    if (Job* const job = state_.jobs.Find(each.job)) end_.End(now, *job, JobState::kFailed, each.reason);
  }
  const auto frames = scheduler.TakeFailedFrames();
  for (const FailedFrame& each : frames) {
    if (Job* const job = state_.jobs.Find(each.job)) end_.FailFrame(now, *job, each.frame, each.reason);
  }
  if (!jobs.empty() || !frames.empty()) scheduler.Advance(now);  // their workers are free
}

// Messages about what the farm has done come after those about what led to it.
FarmOutput Farm::TakeOutput() {
  FarmOutput output = std::exchange(state_.output, {});
  for (const Fact& fact : output.facts) {
    if (auto message = MessageOf(fact, state_.jobs)) output.messages.push_back(std::move(*message));
  }
  for (JobMessage& message : output.messages) {
    if (const Job* const job = state_.jobs.Find(message.job)) message.submission = job->spec->submission;
  }
  return output;
}

Instant Farm::Patience(Instant now) const {
  Instant patience = state_.scheduler.TickInterval();
  if (const auto due = parked_.next_due()) patience = std::min(patience, *due - now);
  if (const auto due = frames_.next_due()) patience = std::min(patience, *due - now);
  return std::max(patience, Instant{0});
}

// ---- Workers ----

Result<void> Farm::CheckAdmission(const WorkerState& state) const {
  return CheckRelease(state);
}

std::string Farm::WhyNoPlace(WorkerId worker) const {
  if (!state_.scheduler.IsFull(worker)) return {};
  return fmt::format("the farm is full: it has {} workers, which is its limit", kWorkersMax);
}

void Farm::Synchronize(Instant now, CallId call, WorkerState state) {
  const bool is_stranger = state.farm != id();
  if (is_stranger) {
    state.leases.clear();
    state.returned_leases.clear();
  }
  state_.scheduler.Synchronize(now, state);
  preparations_.Synchronize(now, state);
  const bool answer_now = state.leaving || is_stranger || state.wait.count() <= 0;
  const Instant wait = answer_now ? Instant{0} : std::min<Instant>(state.wait, kParkMax);
  // An older call of the same worker has nothing more to bring.
  if (const auto older = parked_.Park(state.worker, call, now + wait)) PushDirective(*older, {});
}

void Farm::Cut(Instant now, CallId call) {
  const auto worker = parked_.WorkerOf(call);
  if (!worker) return;
  parked_.Take(*worker);
  state_.scheduler.Disconnect(now, *worker);
}

void Farm::ReturnResults(Instant now, CallId call, WorkerId worker, std::vector<ReturnedUnit> units) {
  PendingResults pending{call, worker, {}, {}};
  for (ReturnedUnit& unit : units) {
    std::string reason;
    pending.verdicts.push_back(results_.Accept(now, worker, unit, reason));
    if (pending.verdicts.back() == Verdict::kRefused) pending.reasons.push_back(std::move(reason));
  }
  pending_results_.push_back(std::move(pending));
}

void Farm::FailUnit(WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& reason) {
  state_.scheduler.FailUnit(worker, lease, unit, reason);
}

void Farm::FailScene(WorkerId worker, const Digest& scene, const std::string& reason, FailureCause cause) {
  state_.scheduler.FailScene(worker, scene, reason, cause);
}

void Farm::AnswerResults(Instant now) {
  for (PendingResults& pending : std::exchange(pending_results_, {})) {
    LeaseGrants grants = state_.scheduler.TakeGrants(now, pending.worker);
    state_.output.results.push_back(
        {pending.call, std::move(pending.verdicts), std::move(pending.reasons), std::move(grants), id()});
  }
}

void Farm::AnswerParked(Instant now) {
  std::vector<WorkerId> with_news;
  for (const WorkerId worker : state_.scheduler.news()) {
    if (parked_.Has(worker) && state_.scheduler.HasNews(worker)) with_news.push_back(worker);
  }
  for (const WorkerId worker : preparations_.News()) {
    if (parked_.Has(worker) && std::ranges::find(with_news, worker) == with_news.end())
      with_news.push_back(worker);
  }
  for (const WorkerId worker : with_news) Answer(now, worker);
  while (const auto due = parked_.FirstDue(now)) Answer(now, *due);
}

void Farm::Answer(Instant now, WorkerId worker) {
  WorkerDirective directive = state_.scheduler.TakeDirective(now, worker);
  directive.preparation = preparations_.Take(now, worker);
  PushDirective(*parked_.Take(worker), std::move(directive));
}

void Farm::PushDirective(CallId call, WorkerDirective directive) {
  directive.farm = id();
  state_.output.directives.push_back({call, std::move(directive)});
}

std::vector<WorkerStatus> Farm::FindWorkers(Instant now, const std::string& which) const {
  std::vector<WorkerStatus> found = Workers(now);
  std::erase_if(found, [&](const WorkerStatus& worker) {
    return worker.name != which && fmt::format("{:016x}", Number(worker.worker)) != which;
  });
  return found;
}

// ---- Clients ----

std::optional<Result<JobId>> Farm::FindOrRefuse(uint64_t submission, const JobOwner& owner,
                                                uint64_t bytes) const {
  if (const Job* const known = state_.jobs.FindSubmission(submission)) {
    if (known->owner.member == owner.member) return known->id;
    return BadInput("another owner's job already has this submission number; submit the scene again");
  }
  if (state_.jobs.open().size() >= kOpenJobsMax)
    return Failed(fmt::format(
        "the farm already has {} open jobs, which is its limit; wait for a job to end or cancel one",
        kOpenJobsMax));
  if (const auto room = state_.jobs.CheckSpecBytes(bytes); !room) return room.error();
  return std::nullopt;
}

Result<JobId> Farm::Order(Instant now, std::shared_ptr<const JobOrder> order, const JobOwner& owner) {
  if (const auto known = FindOrRefuse(order->submission, owner, sizeof *order + order->scene.options.size()))
    return *known;
  if (!preparations_.HasPlace(owner))
    return Failed(
        fmt::format("you already have {} jobs waiting to be prepared (the limit); wait for one of them",
                    kOrdersPerOwnerMax));
  Job& job = state_.jobs.Add(state_.jobs.next_id(), order);
  job.owner = owner;
  job.began = now;
  job.clock.begun = counters();
  preparations_.Add(job);
  if (owner != JobOwner{}) state_.output.facts.emplace_back(JobOwned{job.id, owner});
  state_.output.facts.emplace_back(TimedOf(state_, job));
  state_.output.facts.emplace_back(JobOrdered{job.id, order});
  Log(fmt::format("job_ordered job={} name={} owner={} priority={}", Number(job.id), LogText(order->name),
                  LogText(owner.name), order->priority));
  return job.id;
}

Result<JobId> Farm::Submit(Instant now, std::shared_ptr<const JobSpec> spec, const JobOwner& owner) {
  if (const auto known = FindOrRefuse(spec->submission, owner, MemoryOf(*spec))) return *known;
  Job& job = state_.jobs.Add(state_.jobs.next_id(), spec);
  job.owner = owner;
  job.began = now;
  job.clock.begun = counters();
  state_.scheduler.AddJob(job);
  if (owner != JobOwner{}) state_.output.facts.emplace_back(JobOwned{job.id, owner});
  state_.output.facts.emplace_back(TimedOf(state_, job));
  state_.output.facts.emplace_back(JobSubmitted{job.id, spec});
  Log(fmt::format("job_submitted job={} name={} owner={} priority={} frames={} samples={}", Number(job.id),
                  LogText(spec->name), LogText(owner.name), spec->priority, spec->frames.size(),
                  job.results.samples_total));
  return job.id;
}

const JobOwner* Farm::OwnerOf(JobId id) const {
  const Job* const job = state_.jobs.Find(id);
  return job == nullptr ? nullptr : &job->owner;
}

Result<JobStatus> Farm::Cancel(Instant now, JobId id) {
  Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return NoSuchJob(id);
  end_.End(now, *job, JobState::kCancelled, "");
  return StatusOf(state_, now, *job);
}

Result<JobStatus> Farm::Extend(Instant now, JobId id, uint32_t samples_per_pixel) {
  Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return NoSuchJob(id);
  TESSERA_CHECK(!IsMovingSums(id));
  if (job->order != nullptr)
    return BadInput(fmt::format("job {} has no frames: its scene is not prepared", Number(id)));
  if (const auto extended = extension_.Extend(now, *job, samples_per_pixel); !extended)
    return extended.error();
  return StatusOf(state_, now, *job);
}

Result<JobStatus> Farm::SetPaused(Instant now, JobId id, bool paused) {
  const auto found = state_.jobs.FindOpen(id, paused ? "paused" : "resumed");
  if (!found) return found.error();
  Job& job = **found;
  if (job.is_paused != paused) {
    if (job.order != nullptr) {
      job.is_paused = paused;
    } else {
      state_.scheduler.SetPaused(now, job, paused);
    }
    state_.output.facts.emplace_back(JobPaused{id, paused});
    Log(fmt::format("{} job={}", paused ? "job_paused" : "job_continued", Number(id)));
  }
  return StatusOf(state_, now, job);
}

Result<JobStatus> Farm::SetPriority(Instant now, JobId id, int32_t priority) {
  const auto found = state_.jobs.FindOpen(id, "given another priority");
  if (!found) return found.error();
  Job& job = **found;
  if (job.priority != priority) {
    if (job.order != nullptr) {
      job.priority = priority;
    } else {
      state_.scheduler.SetPriority(job, priority);
    }
    state_.output.facts.emplace_back(JobPriorityChanged{id, priority});
    Log(fmt::format("job_priority job={} priority={}", Number(id), priority));
  }
  return StatusOf(state_, now, job);
}

bool Farm::IsMovingSums(JobId id) const {
  const Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return false;
  const JobResults& results = job->results;
  return !(results.writing.empty() && results.loading.empty() && results.remaking.empty());
}

std::shared_ptr<const JobSpec> Farm::Spec(JobId id) const {
  const Job* const job = state_.jobs.Find(id);
  return job == nullptr ? nullptr : job->spec;
}

std::optional<JobStatus> Farm::Status(Instant now, JobId id) const {
  const Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return std::nullopt;
  return StatusOf(state_, now, *job);
}

std::vector<JobStatus> Farm::Jobs(Instant now) const {
  std::vector<JobStatus> all;
  for (const auto& [id, job] : state_.jobs.all()) all.push_back(StatusOf(state_, now, job));
  return all;
}

std::vector<FrameStatus> Farm::Frames(JobId id) const {
  std::vector<FrameStatus> frames;
  const Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return frames;
  for (uint32_t i = 0; i < job->spec->frames.size(); ++i) {
    const auto file = FinishedFile(id, i);
    frames.push_back(
        {job->spec->frames[i].number, file ? std::optional(file->digest) : std::nullopt, HasFailed({id, i})});
  }
  return frames;
}

bool Farm::HasFailed(FrameId id) const {
  const Job* const job = state_.jobs.Find(id.job);
  return job != nullptr && job->results.failed.contains(id.frame);
}

std::vector<Digest> Farm::PackagesInUse() const {
  std::set<Digest> packages;
  for (const JobId id : state_.jobs.open()) packages.insert(state_.jobs.At(id).spec->package);
  return {packages.begin(), packages.end()};
}

std::optional<Digest> Farm::SceneOf(FrameId id) const {
  const Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr || id.frame >= job->submitted->frames.size()) return std::nullopt;
  return job->SceneOf(id.frame);
}

std::optional<PictureFile> Farm::FinishedFile(JobId id, uint32_t frame) const {
  const Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return std::nullopt;
  const auto file = job->results.files.find(frame);
  return file == job->results.files.end() ? std::nullopt : std::optional(file->second);
}

std::vector<std::pair<FrameId, PictureFile>> Farm::FinishedFiles() const {
  std::vector<std::pair<FrameId, PictureFile>> files;
  for (const auto& [id, job] : state_.jobs.all()) {
    for (const auto& [frame, file] : job.results.files) files.push_back({{id, frame}, file});
  }
  return files;
}

std::optional<std::string> Farm::PictureDamaged(FrameId id, const std::string& reason) {
  if (frames_.PictureDamaged(id, reason)) return std::nullopt;
  const Job* const job = state_.jobs.Find(id.job);
  const bool is_known = job != nullptr && job->results.lost.contains(id.frame);
  return is_known ? job->results.lost.at(id.frame) : reason;
}

std::vector<FrameId> Farm::GiveUpSums(const std::set<FrameId>& needed) {
  std::vector<FrameId> given_up;
  for (const FrameId id : state_.kept_sums.Frames()) {
    const bool is_needed = needed.contains(id) || state_.jobs.At(id.job).results.remaking.contains(id.frame);
    if (is_needed) continue;
    state_.kept_sums.Remove(id);
    given_up.push_back(id);
    Log(fmt::format("sums_given_up job={} frame={}", Number(id.job), id.frame));
    if (given_up.size() == kSumsGivenUpMax) break;
  }
  return given_up;
}

void Farm::StorageDelayed(const std::string& reason) {
  if (!reason.empty() && reason != state_.storage_reason)
    Log(fmt::format("storage_delayed reason={}", LogText(reason)));
  // Those whose results cannot be written. There may be thousands of others, which wait all the same.
  if (reason.empty() != state_.storage_reason.empty()) {
    for (const JobId id : state_.jobs.open()) {
      if (state_.jobs.At(id).results.mergers.empty()) continue;
      if (reason.empty()) {
        state_.AddMessage(MessageLevel::kInfo, id, "the coordinator can write its data again");
      } else {
        state_.AddMessage(MessageLevel::kWarning, id, "the coordinator cannot write its data: " + reason);
      }
    }
  }
  state_.storage_reason = reason;
}

}  // namespace tessera
