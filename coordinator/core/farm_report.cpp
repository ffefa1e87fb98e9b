// Where the farm's time went while a job was open: differences of the farm's counters between the moments of
// the job, and what was rendered for the job itself.
#include <algorithm>

#include "coordinator/core/farm.h"

namespace tessera {

void Farm::CountResult(Verdict verdict, const ReturnedUnit& returned) {
  JobEntry* const job = FindJob(returned.unit.job);
  FarmCounters& all = counters();
  if (verdict == Verdict::kAccepted) {
    if (job != nullptr) job->clock.render_s += returned.render_seconds;
    return;  // the scheduler has counted it
  }
  uint64_t& units = verdict == Verdict::kDuplicate  ? all.units_duplicate
                    : verdict == Verdict::kObsolete ? all.units_obsolete
                                                    : all.units_refused;
  ++units;
  if (returned.tile) all.samples_wasted += PixelSamples(*returned.tile);
  all.waste_s += returned.render_seconds;
  if (job != nullptr) job->clock.waste_s += returned.render_seconds;
}

void Farm::CountGivenUp() {
  for (const auto& [id, seconds] : scheduler_.TakeGivenUp()) {
    if (JobEntry* const job = FindJob(id)) job->clock.waste_s += seconds;
  }
}

// A job goes from one phase to the next, and back when units of it are open again.
void Farm::MeasurePhase(JobEntry& job) {
  using Phase = Scheduler::Phase;
  const Phase phase = scheduler_.PhaseOf(job.id);
  JobClock& clock = job.clock;
  if (phase == clock.phase) return;
  if (clock.phase == Phase::kOpen) clock.tail = counters();
  if (phase == Phase::kRendered) clock.rendered = counters();
  clock.phase = phase;
}

JobTimes Farm::TimesOf(const JobEntry& job) const {
  using Phase = Scheduler::Phase;
  const JobClock& clock = job.clock;
  const FarmCounters& begun = clock.begun;
  const FarmCounters& now = HasEnded(job.state) ? clock.ended : counters();
  const FarmCounters& rendered = clock.phase == Phase::kRendered ? clock.rendered : now;
  const FarmCounters& tail = clock.phase == Phase::kOpen ? rendered : clock.tail;
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

}  // namespace tessera
