#include "coordinator/core/job_end.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/job_report.h"
#include "coordinator/core/schedule/policy.h"
#include "renderer/text/unicode.h"
#include "renderer/util/check.h"

namespace tessera {

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

void JobEnd::KeepPictures(Job& job) {
  for (const auto& [frame, merger] : job.results.mergers) {
    // While the earlier sums of an extended frame are loaded, its picture without the extension is the better
    // one.
    if (merger.samples_merged() == 0 || job.results.loading.contains(frame)) continue;
    state_.output.partial_pictures.push_back({job.id, frame, job.spec, merger.Snapshot(), false});
    job.results.writing.insert(frame);
  }
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
