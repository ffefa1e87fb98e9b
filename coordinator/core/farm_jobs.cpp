// What clients ask of the farm.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/farm.h"
#include "coordinator/core/policy.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr Instant kProgressInterval = milliseconds(250);
constexpr Instant kProgressWindow =
    seconds(5);  // long enough to be steady, short enough to show what changes

std::chrono::milliseconds ToMilliseconds(Instant duration) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration);
}

std::string PausedReason(const std::string& also) {
  return also.empty() ? "by the user" : "by the user; " + also;
}

}  // namespace

Result<JobId> Farm::Submit(Instant now, std::shared_ptr<const JobSpec> spec) {
  if (const auto known = submissions_.find(spec->submission); known != submissions_.end())
    return known->second;
  if (open_jobs_.size() >= kOpenJobsMax) {
    return Failed(fmt::format("the farm has {} open jobs already, its limit", open_jobs_.size()));
  }
  const JobId id{job_next_};
  JobEntry& job = AddJob(id, spec);
  job.began = now;
  job.clock.begun = counters();
  scheduler_.AddJob(id, spec, {});
  output_.facts.emplace_back(JobSubmitted{id, spec});
  output_.log.push_back(fmt::format("job_submitted job={} name=\"{}\" priority={} frames={} samples={}",
                                    Number(id), spec->name, spec->priority, spec->frames.size(),
                                    job.samples_total));
  return id;
}

void Farm::EndJob(Instant now, JobEntry& job, JobState state, const std::string& reason) {
  TESSERA_CHECK(HasEnded(state));
  if (HasEnded(job.state)) return;
  job.state = state;
  job.reason = reason;
  job.ended = now;
  job.clock.ended = counters();
  job.mergers.clear();
  job.loading.clear();
  job.kept.clear();
  if (state != JobState::kFinished) DropSums(job);
  job.opinions.clear();
  job.unconfirmed.clear();
  open_jobs_.erase(job.id);
  scheduler_.RemoveJob(job.id);
  output_.facts.emplace_back(JobEnded{job.id, state, reason});
  output_.log.push_back(fmt::format(
      "job_ended job={} state={} elapsed_s={:.3f} samples_accepted={} reason=\"{}\"", Number(job.id),
      JobStateName(state), Seconds(now - job.began), job.samples_accepted, reason));
}

void Farm::DropSums(const JobEntry& job) {
  for (uint32_t f = 0; f < job.spec->frames.size(); ++f) {
    kept_sums_.Remove({job.id, f});
    output_.dropped.push_back({job.id, f});
  }
}

void Farm::ForgetEnded() {
  size_t surplus = jobs_.size() - open_jobs_.size();
  surplus -= std::min(surplus, kEndedJobsMax);
  for (auto each = jobs_.begin(); surplus > 0 && each != jobs_.end();) {
    if (!HasEnded(each->second.state)) {
      ++each;
      continue;
    }
    submissions_.erase(each->second.spec->submission);
    DropSums(each->second);
    output_.forgotten.push_back(each->first);
    each = jobs_.erase(each);
    --surplus;
  }
}

Result<JobStatus> Farm::Cancel(Instant now, JobId id) {
  JobEntry* const job = FindJob(id);
  if (job == nullptr) return BadInput(fmt::format("there is no job {}", Number(id)));
  EndJob(now, *job, JobState::kCancelled, "");
  return StatusOf(now, *job);
}

Result<Farm::JobEntry*> Farm::FindOpenJob(JobId id, const char* verb) {
  JobEntry* const job = FindJob(id);
  if (job == nullptr) return BadInput(fmt::format("there is no job {}", Number(id)));
  if (!HasEnded(job->state)) return job;
  return BadInput(
      fmt::format("job {} is {}: it cannot be {} any more", Number(id), JobStateName(job->state), verb));
}

Result<JobStatus> Farm::SetPaused(Instant now, JobId id, bool paused) {
  const auto found = FindOpenJob(id, paused ? "paused" : "resumed");
  if (!found) return found.error();
  JobEntry& job = **found;
  if (job.paused != paused) {
    job.paused = paused;
    scheduler_.SetPaused(now, id, paused);
    output_.facts.emplace_back(JobPaused{id, paused});
    output_.log.push_back(fmt::format("{} job={}", paused ? "job_paused" : "job_continued", Number(id)));
  }
  return StatusOf(now, job);
}

Result<JobStatus> Farm::SetPriority(Instant now, JobId id, int32_t priority) {
  const auto found = FindOpenJob(id, "given another priority");
  if (!found) return found.error();
  JobEntry& job = **found;
  if (job.priority != priority) {
    job.priority = priority;
    scheduler_.SetPriority(id, priority);
    output_.facts.emplace_back(JobPriorityChanged{id, priority});
    output_.log.push_back(fmt::format("job_priority job={} priority={}", Number(id), priority));
  }
  return StatusOf(now, job);
}

std::optional<JobStatus> Farm::Status(Instant now, JobId id) const {
  const JobEntry* const job = FindJob(id);
  if (job == nullptr) return std::nullopt;
  return StatusOf(now, *job);
}

std::vector<JobStatus> Farm::Jobs(Instant now) const {
  std::vector<JobStatus> all;
  for (const auto& [id, job] : jobs_) all.push_back(StatusOf(now, job));
  return all;
}

std::vector<Digest> Farm::PackagesInUse() const {
  std::set<Digest> packages;
  for (const JobId id : open_jobs_) packages.insert(jobs_.at(id).spec->package);
  return {packages.begin(), packages.end()};
}

JobStatus Farm::StatusOf(Instant now, const JobEntry& job) const {
  JobStatus status;
  status.job = job.id;
  status.name = job.spec->name;
  status.priority = job.priority;
  status.reason = job.reason;
  status.samples_done = job.samples_done;
  status.samples_total = job.samples_total;
  status.frames_total = static_cast<uint32_t>(job.spec->frames.size());
  status.frames_finished = static_cast<uint32_t>(job.files.size());
  status.verify_share = job.spec->verify_share;
  status.units_verified = job.units_verified;
  status.units_disputed = job.units_disputed;
  status.units_suspect = job.units_suspect;
  const bool ended = HasEnded(job.state);
  const Instant elapsed = (ended ? job.ended : now) - job.began;
  status.elapsed = ToMilliseconds(elapsed);
  status.times = TimesOf(job);
  if (ended) {
    status.state = job.state;
    if (elapsed.count() > 0)
      status.samples_per_second = static_cast<double>(job.samples_done) / Seconds(elapsed);
    return status;
  }
  status.workers = scheduler_.WorkersOf(job.id);
  const bool begun = status.workers > 0 || job.samples_done > 0;
  if (status.reason.empty()) status.reason = storage_reason_;
  status.paused_by_user = job.paused;
  if (job.paused) status.reason = PausedReason(status.reason);
  status.state = !status.reason.empty() ? JobState::kPaused : begun ? JobState::kRunning : JobState::kWaiting;
  const bool wants_workers = status.workers == 0 && job.samples_done < job.samples_total;
  if (status.reason.empty() && wants_workers) status.reason = scheduler_.Obstacle(job.id);
  if (!job.progress.empty() && now > job.progress.front().at) {
    const Progress& past = job.progress.front();
    status.samples_per_second =
        std::max(0.0, static_cast<double>(job.samples_done) - static_cast<double>(past.samples)) /
        Seconds(now - past.at);
  }
  if (status.samples_per_second > 0 && status.state == JobState::kRunning) {
    const double left_s =
        static_cast<double>(job.samples_total - job.samples_done) / status.samples_per_second;
    status.left = ToMilliseconds(FromSeconds(left_s));
  }
  return status;
}

void Farm::MeasureProgress(Instant now) {
  for (const JobId id : open_jobs_) {
    JobEntry& job = jobs_.at(id);
    MeasurePhase(job);
    // The clock of the rate starts with the first samples: waiting and loading are not rendering.
    if (job.samples_done == 0 && job.progress.empty()) continue;
    if (!job.progress.empty() && now - job.progress.back().at < kProgressInterval) continue;
    job.progress.push_back({now, job.samples_done});
    while (job.progress.size() > 2 && now - job.progress[1].at > kProgressWindow) job.progress.pop_front();
  }
}

std::vector<FrameStatus> Farm::Frames(JobId id) const {
  std::vector<FrameStatus> frames;
  const JobEntry* const job = FindJob(id);
  if (job == nullptr) return frames;
  for (uint32_t i = 0; i < job->spec->frames.size(); ++i) {
    frames.push_back({job->spec->frames[i].number, FinishedFile(id, i)});
  }
  return frames;
}

std::optional<Digest> Farm::FinishedFile(JobId id, uint32_t frame) const {
  const JobEntry* const job = FindJob(id);
  if (job == nullptr) return std::nullopt;
  const auto file = job->files.find(frame);
  if (file == job->files.end()) return std::nullopt;
  return file->second;
}

std::optional<FinishedPicture> Farm::Preview(JobId id, uint32_t frame) const {
  const JobEntry* const job = FindJob(id);
  if (job == nullptr || frame >= job->spec->frames.size() || HasEnded(job->state)) return std::nullopt;
  if (scheduler_.IsComplete(id, frame)) return std::nullopt;
  const auto merger = job->mergers.find(frame);
  FrameSnapshot snapshot = merger == job->mergers.end() ? Merger(job->spec->frames[frame].spec).Snapshot()
                                                        : merger->second.Snapshot();
  return FinishedPicture{id, frame, job->spec, std::move(snapshot)};
}

}  // namespace tessera
