#include "core/farm.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/policy.h"
#include "util/check.h"

namespace tessera {
namespace {

uint64_t SamplesOf(const FrameSpec& spec) {
  return static_cast<uint64_t>(spec.crop.area()) * spec.samples_per_pixel;
}

// What is wrong with a tile that was returned for a unit, or nothing.
std::string Mismatch(const RadianceTile& tile, const WorkUnit& unit, PixelBounds bounds, int channels) {
  if (tile.range != unit.range) {
    return fmt::format("holds samples {} instead of {}", tile.range.Text(), unit.range.Text());
  }
  if (tile.bounds != bounds) return "holds other pixels than the tile's";
  if (tile.channels != channels) return fmt::format("has {} channels instead of {}", tile.channels, channels);
  return {};
}

}  // namespace

Farm::Farm(SchedulerOptions options) : scheduler_(options) {
  output_.facts.emplace_back(CoordinatorStarted{options.epoch});
}

Farm::JobEntry* Farm::FindJob(JobId id) {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second;
}

const Farm::JobEntry* Farm::FindJob(JobId id) const {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second;
}

Farm::JobEntry& Farm::AddJob(JobId id, std::shared_ptr<const JobSpec> spec) {
  JobEntry& job = jobs_[id];
  job.id = id;
  for (const FrameOrder& frame : spec->frames) job.samples_total += SamplesOf(frame.spec);
  submissions_[spec->submission] = id;
  open_jobs_.insert(id);
  job_next_ = std::max(job_next_, Number(id) + 1);
  job.spec = std::move(spec);
  return job;
}

void Farm::Restore(const Fact& fact) {
  if (const auto* submitted = std::get_if<JobSubmitted>(&fact)) {
    AddJob(submitted->job, submitted->spec);
  } else if (const auto* finished = std::get_if<FrameFinished>(&fact)) {
    JobEntry* const job = FindJob(finished->job);
    if (job == nullptr || finished->frame >= job->spec->frames.size()) return;
    job->files[finished->frame] = finished->file;
    job->samples_done += SamplesOf(job->spec->frames[finished->frame].spec);
  } else if (const auto* ended = std::get_if<JobEnded>(&fact)) {
    JobEntry* const job = FindJob(ended->job);
    if (job == nullptr) return;
    job->state = ended->state;
    job->reason = ended->reason;
    open_jobs_.erase(ended->job);
  }
}

void Farm::Begin(Instant now) {
  for (const JobId id : std::set<JobId>(open_jobs_)) {
    JobEntry& job = jobs_.at(id);
    job.began = now;
    std::set<uint32_t> finished;
    for (const auto& [frame, file] : job.files) finished.insert(frame);
    scheduler_.AddJob(id, job.spec, finished);
    output_.log.push_back(fmt::format("job_resumed job={} frames_finished={}", Number(id), finished.size()));
    if (finished.size() == job.spec->frames.size()) EndJob(now, job, JobState::kFinished, "");
  }
  ForgetEnded();
}

Result<void> Farm::CheckAdmission(const WorkerState& state) const {
  if (state.protocol != kProtocolVersion) {
    return Failed(
        fmt::format("worker \"{}\" speaks protocol {}, this coordinator {}: install the same release on both",
                    state.name, state.protocol, kProtocolVersion));
  }
  if (state.software_version != kSoftwareVersion) {
    return Failed(
        fmt::format("worker \"{}\" is version {}, this coordinator {}: install the same release on both",
                    state.name, state.software_version, kSoftwareVersion));
  }
  if (scheduler_.IsFull(state.worker)) return Failed("the farm has too many workers");
  return {};
}

void Farm::Synchronize(Instant now, CallId call, const WorkerState& state) {
  scheduler_.Synchronize(now, state);
  // An older call of the same worker has nothing more to bring.
  if (const auto older = parked_.find(state.worker); older != parked_.end()) {
    output_.directives.push_back({older->second.call, {}});
    parked_calls_.erase(older->second.call);
    parked_.erase(older);
  }
  const bool answer_now = state.leaving || state.wait.count() <= 0;
  const Instant wait = answer_now ? Instant{0} : std::min<Instant>(state.wait, kParkMax);
  parked_[state.worker] = {call, now + wait};
  parked_calls_[call] = state.worker;
}

void Farm::Cut(Instant now, CallId call) {
  const auto found = parked_calls_.find(call);
  if (found == parked_calls_.end()) return;
  const WorkerId worker = found->second;
  parked_calls_.erase(found);
  parked_.erase(worker);
  scheduler_.Disconnect(now, worker);
}

void Farm::ReturnResults(Instant now, CallId call, WorkerId worker, std::vector<ReturnedUnit> units) {
  PendingResults pending{call, worker, {}, {}};
  for (ReturnedUnit& unit : units) {
    std::string reason;
    pending.verdicts.push_back(Accept(now, worker, unit, reason));
    if (pending.verdicts.back() == Verdict::kRefused) pending.reasons.push_back(std::move(reason));
  }
  pending_results_.push_back(std::move(pending));
}

Verdict Farm::Accept(Instant now, WorkerId worker, ReturnedUnit& returned, std::string& reason) {
  const WorkUnit& unit = returned.unit;
  JobEntry* const job = FindJob(unit.job);
  if (job == nullptr || HasEnded(job->state)) return Verdict::kObsolete;
  if (unit.frame < job->spec->frames.size() && scheduler_.IsComplete(unit.job, unit.frame))
    return Verdict::kDuplicate;
  const bool known = scheduler_.IsKnown(unit);
  if (!known) {
    reason = "there is no such unit";
  } else if (!returned.tile) {
    reason = returned.tile.error().message;
  } else {
    const int channels = job->spec->frames[unit.frame].spec.channel_count();
    reason = Mismatch(*returned.tile, unit, scheduler_.Bounds(unit), channels);
  }
  if (!reason.empty()) {
    reason = fmt::format("result of {} refused: {}", unit.Text(), reason);
    scheduler_.RefuseResult(now, worker, returned.lease, unit, reason);
    return Verdict::kRefused;
  }
  if (!scheduler_.Finish(now, worker, returned.lease, unit, returned.render_seconds))
    return Verdict::kDuplicate;
  Merge(*job, unit, std::move(*returned.tile));
  return Verdict::kAccepted;
}

void Farm::Merge(JobEntry& job, const WorkUnit& unit, RadianceTile tile) {
  Merger& merger = job.mergers.try_emplace(unit.frame, job.spec->frames[unit.frame].spec).first->second;
  const uint64_t before = merger.samples_merged();
  const auto outcome = merger.Add(static_cast<int>(unit.tile), std::move(tile));
  TESSERA_CHECK(outcome && *outcome == Merger::Outcome::kMerged);  // as the scheduler said
  job.samples_done += merger.samples_merged() - before;
  TESSERA_CHECK(merger.Complete() == scheduler_.IsComplete(job.id, unit.frame));
  if (!merger.Complete()) return;
  output_.pictures.push_back({job.id, unit.frame, job.spec, merger.Picture()});
  job.mergers.erase(unit.frame);
}

void Farm::FailUnit(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                    const std::string& words) {
  scheduler_.FailUnit(now, worker, lease, unit, words);
}

void Farm::FailScene(Instant now, WorkerId worker, const Digest& scene, const std::string& words) {
  scheduler_.FailScene(now, worker, scene, words);
}

void Farm::PictureWritten(Instant now, JobId id, uint32_t frame, const Digest& file) {
  JobEntry* const job = FindJob(id);
  if (job == nullptr || HasEnded(job->state)) return;
  job->files[frame] = file;
  job->reason.clear();
  output_.facts.emplace_back(FrameFinished{id, frame, file});
  output_.log.push_back(fmt::format("frame_finished job={} frame={} file={}", Number(id), frame, file.Hex()));
  if (job->files.size() == job->spec->frames.size()) EndJob(now, *job, JobState::kFinished, "");
}

void Farm::PictureDelayed(JobId id, const std::string& reason) {
  JobEntry* const job = FindJob(id);
  if (job == nullptr || HasEnded(job->state)) return;
  if (job->reason != reason)
    output_.log.push_back(fmt::format("job_paused job={} reason=\"{}\"", Number(id), reason));
  job->reason = reason;
}

void Farm::Advance(Instant now) {
  scheduler_.Advance(now);
  const auto condemned = scheduler_.TakeCondemned();
  for (const auto& each : condemned) {
    if (JobEntry* const job = FindJob(each.job)) EndJob(now, *job, JobState::kFailed, each.reason);
  }
  if (!condemned.empty()) scheduler_.Advance(now);  // their workers are free
  MeasureProgress(now);
  ForgetEnded();
  // Results first: their answers carry what is new for a busy worker, and its waiting call need not be woken.
  for (PendingResults& pending : pending_results_) {
    Scheduler::Grants grants = scheduler_.TakeGrants(now, pending.worker);
    output_.results.push_back(
        {pending.call, std::move(pending.verdicts), std::move(pending.reasons), std::move(grants)});
  }
  pending_results_.clear();
  AnswerParked(now);
  for (std::string& line : scheduler_.TakeLog()) output_.log.push_back(std::move(line));
}

void Farm::AnswerParked(Instant now) {
  std::vector<WorkerId> due;
  for (const auto& [worker, parked] : parked_) {
    if (now >= parked.until || scheduler_.HasNews(worker)) due.push_back(worker);
  }
  for (const WorkerId worker : due) Answer(now, worker, parked_.at(worker).call);
}

void Farm::Answer(Instant now, WorkerId worker, CallId call) {
  output_.directives.push_back({call, scheduler_.TakeDirective(now, worker)});
  parked_calls_.erase(call);
  parked_.erase(worker);
}

Instant Farm::Patience(Instant now) const {
  Instant patience = scheduler_.TickInterval();
  for (const auto& [worker, parked] : parked_) patience = std::min(patience, parked.until - now);
  return std::max(patience, Instant{0});
}

FarmOutput Farm::TakeOutput() {
  return std::exchange(output_, {});
}

}  // namespace tessera
