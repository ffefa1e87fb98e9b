#include "coordinator/core/job_report.h"

#include <algorithm>
#include <cmath>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

constexpr Instant kProgressInterval = milliseconds(250);
// Long enough to be steady, short enough to show what changes.
constexpr Instant kProgressWindow = seconds(5);

std::chrono::milliseconds ToMilliseconds(Instant duration) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration);
}

std::string PausedReason(const std::string& also) {
  return also.empty() ? "by the user" : "by the user; " + also;
}

// Differences of the farm's counters between the moments of the job, and what was rendered for the job
// itself.
JobTimes TimesOf(const FarmState& state, const Job& job) {
  if (job.former_times) return *job.former_times;
  const JobClock& clock = job.clock;
  const FarmCounters& begun = clock.begun;
  const FarmCounters& now = HasEnded(job.state) ? clock.ended : state.scheduler.counters();
  const FarmCounters& rendered = clock.phase == JobPhase::kRendered ? clock.rendered : now;
  const FarmCounters& tail = clock.phase == JobPhase::kOpen ? rendered : clock.tail;
  JobTimes times;
  times.render_s = clock.render_s;
  times.waste_s = clock.waste_s;
  const double worked_s = now.render_s - begun.render_s + now.waste_s - begun.waste_s;
  times.other_s = std::max(0.0, worked_s - clock.render_s - clock.waste_s);
  times.fetch_s = now.fetching_s - begun.fetching_s;
  times.load_s = now.loading_s - begun.loading_s;
  times.idle_s = tail.idle_s - begun.idle_s;
  times.tail_s = rendered.idle_s - tail.idle_s;
  times.writing_s = now.idle_s - rendered.idle_s;
  times.overhead_s = std::max(0.0, now.leased_s - begun.leased_s - worked_s);
  times.merge_s = now.core_s - begun.core_s;
  times.journal_s = now.journal_s - begun.journal_s;
  times.picture_s = now.picture_s - begun.picture_s;
  return times;
}

// A job goes from one phase to the next, and back when units of it are open again.
void MeasurePhase(const FarmState& state, Job& job) {
  const JobPhase phase = state.scheduler.PhaseOf(job);
  JobClock& clock = job.clock;
  if (phase == clock.phase) return;
  if (clock.phase == JobPhase::kOpen) clock.tail = state.scheduler.counters();
  if (phase == JobPhase::kRendered) clock.rendered = state.scheduler.counters();
  clock.phase = phase;
}

// Of the frames of which it is known, those that are being rendered included.
std::optional<double> NoiseOf(const JobResults& results) {
  double sum = results.noise.sum();
  size_t count = results.noise.count();
  for (const auto& [frame, merger] : results.mergers) {
    const auto noise = merger.noise();
    if (!noise) continue;
    sum += *noise;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(std::max(sum, 0.0) / static_cast<double>(count));
}

// The rate of the last seconds and the time left at that rate.
void AddRate(Instant now, const JobResults& results, JobStatus& status) {
  if (results.progress.empty() || now <= results.progress.front().at) return;
  const JobResults::Progress& past = results.progress.front();
  const auto done = static_cast<double>(results.samples_done);
  status.samples_per_second =
      std::max(0.0, done - static_cast<double>(past.samples)) / Seconds(now - past.at);
  if (status.samples_per_second <= 0 || status.state != JobState::kRunning) return;
  const auto left = static_cast<double>(results.samples_total - results.samples_done);
  status.left = ToMilliseconds(FromSeconds(left / status.samples_per_second));
}

}  // namespace

JobTimed TimedOf(const FarmState& state, const Job& job) {
  JobTimed timed{job.id, state.UnixTime_ms(job.began), std::nullopt, {}};
  if (!HasEnded(job.state)) return timed;
  timed.ended_ms = state.UnixTime_ms(job.ended);
  timed.times = TimesOf(state, job);
  return timed;
}

JobStatus StatusOf(const FarmState& state, Instant now, const Job& job) {
  const JobResults& results = job.results;
  JobStatus status;
  status.job = job.id;
  status.name = job.spec->name;
  status.owner = job.owner;
  status.submission = job.spec->submission;
  status.priority = job.priority;
  status.reason = job.reason;
  status.samples_done = results.samples_done;
  status.samples_total = results.samples_total;
  status.frames_total = static_cast<uint32_t>(job.spec->frames.size());
  status.frames_finished = static_cast<uint32_t>(results.files.size());
  status.frames_failed = static_cast<uint32_t>(results.failed.size());
  status.noise = NoiseOf(results);
  status.verify_share = job.spec->verify_share;
  status.units_verified = results.units_verified;
  status.units_disputed = results.units_disputed;
  status.units_suspect = results.units_suspect;
  const bool has_ended = HasEnded(job.state);
  const Instant elapsed = (has_ended ? job.ended : now) - job.began;
  status.elapsed = ToMilliseconds(elapsed);
  status.times = TimesOf(state, job);
  if (has_ended) {
    status.state = job.state;
    if (status.reason.empty() && !results.lost.empty()) status.reason = results.lost.begin()->second;
    if (elapsed.count() > 0)
      status.samples_per_second = static_cast<double>(results.samples_done) / Seconds(elapsed);
    return status;
  }
  if (job.order != nullptr) {
    status.paused_by_user = job.is_paused;
    status.state = job.is_paused ? JobState::kPaused : JobState::kPreparing;
    status.reason = state.storage_reason.empty() ? job.order_problem : state.storage_reason;
    if (job.is_paused) status.reason = PausedReason(status.reason);
    return status;
  }
  status.workers = state.scheduler.WorkersOf(job.id);
  const bool has_begun = status.workers > 0 || results.samples_done > 0;
  if (!results.unwritten.empty()) status.reason = results.unwritten.begin()->second;
  if (status.reason.empty()) status.reason = state.storage_reason;
  status.paused_by_user = job.is_paused;
  if (job.is_paused) status.reason = PausedReason(status.reason);
  // A picture that cannot be written does not stop the frames that are being rendered.
  const bool is_held = job.is_paused || !state.storage_reason.empty() || status.workers == 0;
  status.state = is_held && !status.reason.empty() ? JobState::kPaused
                 : has_begun                       ? JobState::kRunning
                                                   : JobState::kWaiting;
  const bool wants_workers = status.workers == 0 && results.samples_done < results.samples_total;
  if (status.reason.empty() && wants_workers) status.reason = state.scheduler.Obstacle(job.id);
  AddRate(now, results, status);
  return status;
}

void MeasureProgress(FarmState& state, Instant now) {
  for (const JobId id : state.jobs.open()) {
    Job& job = state.jobs.At(id);
    if (job.order != nullptr) continue;
    MeasurePhase(state, job);
    auto& progress = job.results.progress;
    // The clock of the rate starts with the first samples: waiting and loading are not rendering.
    if (job.results.samples_done == 0 && progress.empty()) continue;
    if (!progress.empty() && now - progress.back().at < kProgressInterval) continue;
    progress.push_back({now, job.results.samples_done});
    while (progress.size() > 2 && now - progress[1].at > kProgressWindow) progress.pop_front();
  }
}

void CountGivenUp(FarmState& state) {
  for (const auto& [id, seconds] : state.scheduler.TakeGivenUp()) {
    if (Job* const job = state.jobs.Find(id)) job->clock.waste_s += seconds;
  }
}

}  // namespace tessera
