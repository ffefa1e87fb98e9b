#include "coordinator/core/job_end.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/job_report.h"
#include "coordinator/core/schedule/policy.h"
#include "renderer/text/unicode.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

// Of a job with failed frames.
std::string FailureText(const Job& job) {
  const auto& [first, reason] = *job.results.failed.begin();
  const std::string text = fmt::format("frame {} failed: {}", job.spec->frames[first].number, reason);
  const size_t others = job.results.failed.size() - 1;
  if (others == 0) return text;
  return fmt::format("{}; {} more frame{} failed", text, others, others == 1 ? "" : "s");
}

}  // namespace

void JobEnd::End(Instant now, Job& job, JobState end, const std::string& reason) {
  TESSERA_CHECK(HasEnded(end));
  if (HasEnded(job.state)) return;
  job.state = end;
  job.reason = reason;
  job.ended = now;
  job.clock.ended = state_.scheduler.counters();
  job.results.writing.clear();
  job.results.unwritten.clear();
  if (end != JobState::kFinished) {
    KeepPictures(job);
    job.results.remaking.clear();
  }
  job.in_spool.clear();
  job.results.mergers.clear();
  job.results.loading.clear();
  job.results.unconfirmed.clear();
  if (end != JobState::kFinished) DropSums(job);
  state_.jobs.MarkEnded(job.id);
  state_.scheduler.RemoveJob(job);
  // First the time: a crash between them leaves an open job with the time that it began.
  state_.output.facts.emplace_back(TimedOf(state_, job));
  state_.output.facts.emplace_back(JobEnded{job.id, end, reason});
  state_.output.log.push_back(fmt::format(
      "job_ended job={} state={} elapsed_s={:.3f} samples_accepted={} reason={}", Number(job.id),
      JobStateName(end), Seconds(now - job.began), job.results.samples_accepted, LogText(reason)));
}

void JobEnd::FailFrame(Instant now, Job& job, uint32_t frame, const std::string& reason) {
  JobResults& results = job.results;
  if (HasEnded(job.state) || results.files.contains(frame) || results.writing.contains(frame)) return;
  if (!results.failed.try_emplace(frame, reason).second) return;
  state_.output.facts.emplace_back(FrameFailed{job.id, frame, reason});
  state_.output.log.push_back(
      fmt::format("frame_failed job={} frame={} reason={}", Number(job.id), frame, LogText(reason)));
  KeepPicture(job, frame);
  state_.scheduler.DropFrame(job, frame);
  DropFrameSums(job, frame);
  EndIfDecided(now, job);
}

void JobEnd::DropFrameSums(Job& job, uint32_t frame) {
  JobResults& results = job.results;
  const auto merger = results.mergers.find(frame);
  const bool has_merger = merger != results.mergers.end();
  results.samples_total -=
      has_merger ? merger->second.samples_total() : SamplesOf(job.spec->frames[frame].spec);
  if (has_merger) {
    results.samples_done -= merger->second.samples_merged();
    results.mergers.erase(merger);
  }
  // The sums that an extended frame was finished with are not in its merger yet.
  if (results.loading.erase(frame) + job.in_spool.erase(frame) > 0)
    results.samples_done -= results.frame_samples.at(frame);
  state_.output.dropped.push_back({job.id, frame});
}

void JobEnd::EndIfDecided(Instant now, Job& job) {
  const size_t failed = job.results.failed.size(), finished = job.results.files.size();
  const bool is_done = failed + finished == job.spec->frames.size();
  const bool is_given_up = failed >= kFailedFramesMax &&
                           static_cast<double>(failed) > kFailedFramesShare * static_cast<double>(finished);
  if (is_done && failed == 0) return End(now, job, JobState::kFinished, "");
  if (is_done || is_given_up) End(now, job, JobState::kFailed, FailureText(job));
}

void JobEnd::KeepPictures(Job& job) {
  for (const auto& [frame, merger] : job.results.mergers) {
    if (KeepPicture(job, frame)) job.results.writing.insert(frame);
  }
}

bool JobEnd::KeepPicture(const Job& job, uint32_t frame) {
  const auto merger = job.results.mergers.find(frame);
  // While the earlier sums of an extended frame are loaded, its picture without the extension is the better
  // one.
  if (merger == job.results.mergers.end() || merger->second.samples_merged() == 0 ||
      job.results.loading.contains(frame))
    return false;
  state_.output.partial_pictures.push_back({job.id, frame, job.spec, merger->second.Snapshot(), false});
  return true;
}

void JobEnd::DropSums(const Job& job) {
  for (uint32_t f = 0; f < job.spec->frames.size(); ++f) {
    state_.kept_sums.Remove({job.id, f});
    state_.output.dropped.push_back({job.id, f});
  }
}

void JobEnd::ForgetOldest() {
  size_t surplus = state_.jobs.all().size() - state_.jobs.open().size();
  surplus -= std::min(surplus, kEndedJobsMax);
  const auto is_too_much = [&] { return surplus > 0 || state_.jobs.spec_bytes() > kSpecBytesMax; };
  for (auto each = state_.jobs.all().begin(); is_too_much() && each != state_.jobs.all().end();) {
    const auto& [id, job] = *each++;
    if (!HasEnded(job.state)) continue;
    DropSums(job);
    state_.output.forgotten.push_back(id);
    state_.jobs.Remove(JobId{id});
    surplus -= std::min<size_t>(surplus, 1);
  }
}

}  // namespace tessera
