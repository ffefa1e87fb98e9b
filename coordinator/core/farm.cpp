#include "coordinator/core/farm.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/policy.h"
#include "proto/probe.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

std::string Hexadecimal(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return text;
}

}  // namespace

Farm::Farm(SchedulerOptions options, uint64_t kept_bytes_max)
    : scheduler_(options), epoch_(options.epoch), kept_sums_(kept_bytes_max) {
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
  job.samples_total = SamplesOf(*spec);
  submissions_[spec->submission] = id;
  open_jobs_.insert(id);
  job_next_ = std::max(job_next_, Number(id) + 1);
  job.priority = spec->priority;
  job.submitted = job.spec = std::move(spec);
  return job;
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
  if (const std::string digest = Hexadecimal(state.probe_digest); !digest.empty() && digest != kProbeDigest) {
    return Failed(fmt::format(
        "worker \"{}\" computes other pictures: its probe unit has digest {}, this release's has {}: its "
        "processor, system libraries or build differ",
        state.name, digest, kProbeDigest));
  }
  if (scheduler_.IsFull(state.worker)) return Failed("the farm has too many workers");
  return {};
}

void Farm::Synchronize(Instant now, CallId call, const WorkerState& state) {
  scheduler_.Synchronize(now, state);
  // An older call of the same worker has nothing more to bring.
  if (const auto older = parked_.find(state.worker); older != parked_.end()) {
    output_.directives.push_back({older->second.call, {}});
    Unpark(state.worker);
  }
  const bool answer_now = state.leaving || state.wait.count() <= 0;
  const Instant wait = answer_now ? Instant{0} : std::min<Instant>(state.wait, kParkMax);
  parked_[state.worker] = {call, now + wait};
  parked_calls_[call] = state.worker;
  parked_until_.emplace(now + wait, state.worker);
}

void Farm::Unpark(WorkerId worker) {
  const auto found = parked_.find(worker);
  parked_calls_.erase(found->second.call);
  parked_until_.erase({found->second.until, worker});
  parked_.erase(found);
}

void Farm::Cut(Instant now, CallId call) {
  const auto found = parked_calls_.find(call);
  if (found == parked_calls_.end()) return;
  const WorkerId worker = found->second;
  Unpark(worker);
  scheduler_.Disconnect(now, worker);
}

void Farm::ReturnResults(Instant now, CallId call, WorkerId worker, std::vector<ReturnedUnit> units) {
  PendingResults pending{call, worker, {}, {}};
  for (ReturnedUnit& unit : units) {
    std::string reason;
    pending.verdicts.push_back(Accept(now, worker, unit, reason));
    CountResult(pending.verdicts.back(), unit);
    if (pending.verdicts.back() == Verdict::kRefused) pending.reasons.push_back(std::move(reason));
  }
  pending_results_.push_back(std::move(pending));
}

// Whether the unit is of samples of which it is not known yet whether its tile will want them, and of which
// pixels. No lease asks for such a unit.
bool Farm::IsEarly(JobEntry& job, const WorkUnit& unit) {
  if (!job.spec->frames[unit.frame].spec.IsAdaptive()) return false;
  const TileGoal& goal = MergerOf(job, unit.frame).Goal(static_cast<int>(unit.tile));
  return !goal.is_final && unit.range.end() > goal.samples;
}

// What is wrong with a tile that was returned for a unit, or nothing.
std::string Farm::Mismatch(JobEntry& job, const WorkUnit& unit, const RadianceTile& tile) {
  if (tile.range != unit.range) {
    return fmt::format("holds samples {} instead of {}", tile.range.Text(), unit.range.Text());
  }
  if (tile.bounds != scheduler_.Bounds(unit)) return "holds other pixels than the tile's";
  const FrameSpec& spec = job.spec->frames[unit.frame].spec;
  if (tile.channels != spec.channel_count())
    return fmt::format("has {} channels instead of {}", tile.channels, spec.channel_count());
  if (!spec.IsAdaptive()) return {};
  const Merger& merger = MergerOf(job, unit.frame);
  const int index = static_cast<int>(unit.tile);
  const bool fits = merger.Has(index, unit.range) || HasExactly(spec, merger.Goal(index).pixels, tile);
  return fits ? "" : "holds samples of other pixels than those asked for";
}

Verdict Farm::Accept(Instant now, WorkerId worker, ReturnedUnit& returned, std::string& reason) {
  const WorkUnit& unit = returned.unit;
  JobEntry* const job = FindJob(unit.job);
  if (job == nullptr || HasEnded(job->state)) return Verdict::kObsolete;
  if (!scheduler_.IsTrusted(worker)) {
    reason = fmt::format("result of {} refused: the worker is in quarantine", unit.Text());
    return Verdict::kRefused;
  }
  if (unit.frame < job->spec->frames.size() && scheduler_.IsComplete(unit.job, unit.frame))
    return Verdict::kDuplicate;
  const bool known = scheduler_.IsKnown(unit);
  if (known && IsEarly(*job, unit)) return Verdict::kObsolete;
  if (!known) {
    reason = "there is no such unit";
  } else if (!returned.tile) {
    reason = returned.tile.error().message;
  } else {
    reason = Mismatch(*job, unit, *returned.tile);
  }
  if (!reason.empty()) {
    reason = fmt::format("result of {} refused: {}", unit.Text(), reason);
    scheduler_.RefuseResult(now, worker, returned.lease, unit, reason);
    return Verdict::kRefused;
  }
  const bool is_verified = scheduler_.NeedsVerification(unit);
  if (is_verified) {
    if (const auto verdict = Verify(now, *job, worker, returned)) return *verdict;
  }
  if (!scheduler_.Finish(now, worker, returned.lease, unit, returned.render_seconds))
    return Verdict::kDuplicate;
  if (!is_verified && job->spec->verify_share > 0) ++job->unconfirmed[worker];
  const uint64_t before = job->samples_done;
  Merge(*job, unit, std::move(*returned.tile));
  scheduler_.CountAccepted(worker, job->samples_done > before ? job->samples_done - before : 0,
                           returned.render_seconds);
  return Verdict::kAccepted;
}

void Farm::Merge(JobEntry& job, const WorkUnit& unit, RadianceTile tile) {
  job.samples_accepted += PixelSamples(tile);
  TileNode node{unit.tile, tile.range, std::move(tile.sums)};
  output_.accepted.push_back({{job.id, unit.frame}, node});
  Merger& merger = MergerOf(job, unit.frame);
  const uint64_t merged = merger.samples_merged();
  const uint64_t total = merger.samples_total();
  const auto outcome = merger.Add(std::move(node));
  TESSERA_CHECK(outcome && *outcome == Merger::Outcome::kMerged);  // as the scheduler said
  job.samples_done += merger.samples_merged() - merged;
  job.samples_total -= total - merger.samples_total();
  if (merger.spec().IsAdaptive())
    scheduler_.SetGoal(job.id, unit.frame, unit.tile, merger.Goal(static_cast<int>(unit.tile)));
  if (job.loading.contains(unit.frame)) return;
  TESSERA_CHECK(merger.Complete() == scheduler_.IsComplete(job.id, unit.frame));
  if (merger.Complete()) CompleteFrame(job, unit.frame);
}

Merger& Farm::MergerOf(JobEntry& job, uint32_t frame) {
  const auto found = job.mergers.find(frame);
  if (found != job.mergers.end()) return found->second;
  if (job.kept.erase(frame) > 0) {
    job.loading.insert(frame);
    output_.facts.emplace_back(FrameResumed{job.id, frame});
    output_.loads.push_back({job.id, frame});
  }
  return job.mergers.try_emplace(frame, job.spec->frames[frame].spec).first->second;
}

void Farm::CompleteFrame(JobEntry& job, uint32_t frame) {
  Merger& merger = job.mergers.at(frame);
  output_.pictures.push_back({job.id, frame, job.spec, merger.Snapshot()});
  job.taken[frame] = merger.samples_merged();
  if (MayKeep(job)) output_.sums.push_back({{job.id, frame}, merger.TakeNodes()});
  job.mergers.erase(frame);
  job.writing.insert(frame);
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
  job->writing.erase(frame);
  std::erase_if(job->opinions, [&](const auto& each) { return each.first.frame == frame; });
  job->reason.clear();
  output_.facts.emplace_back(FrameFinished{id, frame, file, job->taken.at(frame)});
  output_.log.push_back(fmt::format("frame_finished job={} frame={} file={}", Number(id), frame, file.Hex()));
  KeepSums(*job, frame);
  if (job->files.size() == job->spec->frames.size()) EndJob(now, *job, JobState::kFinished, "");
}

void Farm::PictureDelayed(JobId id, const std::string& reason) {
  JobEntry* const job = FindJob(id);
  if (job == nullptr || HasEnded(job->state)) return;
  if (job->reason != reason)
    output_.log.push_back(fmt::format("job_paused job={} reason=\"{}\"", Number(id), reason));
  job->reason = reason;
}

void Farm::StorageDelayed(const std::string& reason) {
  if (!reason.empty() && reason != storage_reason_)
    output_.log.push_back(fmt::format("storage_delayed reason=\"{}\"", reason));
  storage_reason_ = reason;
}

std::optional<std::vector<TileNode>> Farm::Sums(FrameId id) const {
  const JobEntry* const job = FindJob(id.job);
  if (job == nullptr || job->loading.contains(id.frame)) return std::nullopt;
  const auto merger = job->mergers.find(id.frame);
  if (merger == job->mergers.end()) return std::nullopt;
  return merger->second.AllNodes();
}

void Farm::Advance(Instant now) {
  scheduler_.Advance(now);
  NoteBars();
  NoteSuspects();
  const auto condemned = scheduler_.TakeCondemned();
  for (const auto& each : condemned) {
    if (JobEntry* const job = FindJob(each.job)) EndJob(now, *job, JobState::kFailed, each.reason);
  }
  if (!condemned.empty()) scheduler_.Advance(now);  // their workers are free
  CountGivenUp();
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
  for (const WorkerId worker : scheduler_.news()) {
    if (parked_.contains(worker) && scheduler_.HasNews(worker)) due.push_back(worker);
  }
  for (const WorkerId worker : due) Answer(now, worker);
  while (!parked_until_.empty() && parked_until_.begin()->first <= now) {
    Answer(now, parked_until_.begin()->second);
  }
}

void Farm::Answer(Instant now, WorkerId worker) {
  output_.directives.push_back({parked_.at(worker).call, scheduler_.TakeDirective(now, worker)});
  Unpark(worker);
}

Instant Farm::Patience(Instant now) const {
  Instant patience = scheduler_.TickInterval();
  if (!parked_until_.empty()) patience = std::min(patience, parked_until_.begin()->first - now);
  return std::max(patience, Instant{0});
}

FarmOutput Farm::TakeOutput() {
  return std::exchange(output_, {});
}

}  // namespace tessera
