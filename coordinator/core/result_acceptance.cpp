#include "coordinator/core/result_acceptance.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "renderer/film/adaptive.h"
#include "renderer/util/check.h"

namespace tessera {

namespace {

// Whether the unit is of samples that the frame had been extended to in another history of the farm.
bool IsBeyond(const Job& job, const WorkUnit& unit) {
  const FrameRequest& frame = job.spec->frames[unit.frame];
  return IsExtendable(frame) && unit.range.end() > frame.spec.samples_per_pixel;
}

// Whether it is not decided yet if the tile gets these samples, and in which pixels.
bool IsBeyondGoal(const TileGoal& goal, const SampleRange& range) {
  return !goal.is_final && range.end() > goal.samples;
}

}  // namespace

Verdict ResultAcceptance::Accept(Instant now, WorkerId worker, ReturnedUnit& returned, std::string& reason) {
  Job* const job = state_.jobs.Find(returned.unit.job);
  // Numbers alone do not say which picture a result is for: the address, the data directory or its contents
  // may have changed since the unit was leased. The worker is not at fault.
  const bool is_wanted = job != nullptr && !HasEnded(job->state) && returned.farm == state_.id &&
                         job->Has(returned.unit) && !IsBeyond(*job, returned.unit);
  const Verdict verdict = is_wanted ? Decide(now, worker, *job, returned, reason) : Verdict::kObsolete;
  if (verdict == Verdict::kAccepted) {
    job->clock.render_s += returned.render_seconds;
  } else {
    CountUnmerged(verdict, returned, job);
  }
  return verdict;
}

Verdict ResultAcceptance::Decide(Instant now, WorkerId worker, Job& job, ReturnedUnit& returned,
                                 std::string& reason) {
  Scheduler& scheduler = state_.scheduler;
  const WorkUnit& unit = returned.unit;
  if (!scheduler.IsTrusted(worker)) {
    reason = fmt::format("result of {} refused: the worker is in quarantine", unit.Text());
    return Verdict::kRefused;
  }
  if (scheduler.IsComplete(job, unit.frame)) return Verdict::kDuplicate;
  if (!scheduler.IsKnown(unit)) {
    reason = "there is no such unit";
  } else {
    if (!scheduler.IsBegun(unit)) return Verdict::kObsolete;
    if (scheduler.WorkOf(unit).IsDone({unit.tile, unit.range})) return Verdict::kDuplicate;
    // This worker was not asked for it.
    if (!scheduler.MayHaveLeased(worker, returned.lease, unit) ||
        IsBeyondGoal(scheduler.WorkOf(unit).Goal(unit.tile), unit.range))
      return Verdict::kObsolete;
    reason = returned.tile ? Mismatch(job, returned) : returned.tile.error().message;
  }
  if (!reason.empty()) {
    reason = fmt::format("result of {} refused: {}", unit.Text(), reason);
    scheduler.RefuseResult(worker, returned.lease, unit, reason);
    return Verdict::kRefused;
  }
  const bool is_verified = scheduler.NeedsVote(unit);
  if (is_verified) {
    if (const auto verdict = Verify(now, job, worker, returned)) return *verdict;
  }
  if (!scheduler.Finish(now, worker, returned.lease, unit, returned.render_seconds))
    return Verdict::kDuplicate;
  if (!is_verified && job.spec->verify_share > 0) ++job.results.unconfirmed[worker];
  const uint64_t before = job.results.samples_done;
  Merge(job, unit, std::move(*returned.tile));
  const uint64_t after = job.results.samples_done;
  scheduler.CountAccepted(worker, after > before ? after - before : 0, returned.render_seconds);
  return Verdict::kAccepted;
}

// Whether the tile is as large as its unit says, so that looking at its pixels is cheap.
bool ResultAcceptance::HasForm(const Job& job, const ReturnedUnit& returned) {
  const WorkUnit& unit = returned.unit;
  if (!returned.tile || unit.frame >= job.spec->frames.size()) return false;
  const FrameSpec& spec = job.spec->frames[unit.frame].spec;
  return unit.tile < static_cast<uint32_t>(spec.TileCount()) && returned.tile->range == unit.range &&
         returned.tile->bounds == spec.TileBounds(static_cast<int>(unit.tile));
}

// What is wrong with a tile that was returned for a known unit, or empty.
std::string ResultAcceptance::Mismatch(const Job& job, const ReturnedUnit& returned) const {
  const WorkUnit& unit = returned.unit;
  const RadianceTile& tile = *returned.tile;
  const FrameSpec& spec = job.spec->frames[unit.frame].spec;
  if (tile.range != unit.range)
    return fmt::format("has samples {}, expected {}", tile.range.Text(), unit.range.Text());
  if (tile.bounds != spec.TileBounds(static_cast<int>(unit.tile)))
    return "does not have the bounds of its tile";
  const ChannelLayout& layout = state_.scheduler.LayoutOf(unit);
  if (tile.shape != layout.shape())
    return fmt::format("has {} channels, expected {}", tile.shape.stride(), layout.shape().stride());
  if (!spec.IsAdaptive()) return {};
  const FrameWork& work = state_.scheduler.WorkOf(unit);
  const bool fits = work.IsDone({unit.tile, unit.range}) || HasExactly(layout, work.Pixels(unit.tile), tile);
  return fits ? "" : "holds samples of other pixels than those requested";
}

// Records what the worker returned; nullopt if the result is accepted.
std::optional<Verdict> ResultAcceptance::Verify(Instant now, Job& job, WorkerId worker,
                                                const ReturnedUnit& returned) {
  const Digest result = RadianceTileDigest(*returned.tile);
  const VoteOutcome outcome = state_.scheduler.RecordVote(now, worker, returned.lease, returned.unit,
                                                          returned.render_seconds, result);
  if (outcome.vote) {
    const bool is_accepted = outcome.kind == VoteOutcome::Kind::kAccepted;
    job.results.units_verified += is_accepted ? 1 : 0;
    job.results.units_disputed += outcome.is_disputed ? 1 : 0;
    state_.output.facts.emplace_back(
        VoteRecorded{returned.unit, worker, outcome.vote->name, result, outcome.vote->machine});
  }
  switch (outcome.kind) {
    case VoteOutcome::Kind::kHeld: return Verdict::kAccepted;
    case VoteOutcome::Kind::kUseless: return Verdict::kDuplicate;
    case VoteOutcome::Kind::kAccepted: break;
  }
  return std::nullopt;
}

void ResultAcceptance::Merge(Job& job, const WorkUnit& unit, RadianceTile tile) {
  if (job.results.samples_accepted == 0) state_.AddMessage(MessageLevel::kInfo, job.id, "rendering");
  job.results.samples_accepted += PixelSamples(tile);
  Merger& merger = frames_.MergerOf(job, unit.frame);
  TileNode node{unit.tile, tile.range, std::move(tile.sums), merger.channels()};
  state_.output.accepted.push_back({{job.id, unit.frame}, node});
  const uint64_t merged = merger.samples_merged();
  const uint64_t total = merger.samples_total();
  TESSERA_CHECK(merger.Add(std::move(node)).has_value());  // Mismatch has checked it
  job.results.samples_done += merger.samples_merged() - merged;
  job.results.samples_total -= total - merger.samples_total();
  if (merger.spec().IsAdaptive())
    state_.scheduler.SetGoal(job, unit.frame, unit.tile, merger.Goal(static_cast<int>(unit.tile)));
  const bool is_loading = job.results.loading.contains(unit.frame);
  if (!is_loading && state_.scheduler.IsComplete(job, unit.frame)) frames_.Complete(job, unit.frame);
}

void ResultAcceptance::CountUnmerged(Verdict verdict, const ReturnedUnit& returned, Job* job) {
  FarmCounters& counters = state_.scheduler.counters();
  uint64_t& units = verdict == Verdict::kDuplicate  ? counters.units_duplicate
                    : verdict == Verdict::kObsolete ? counters.units_obsolete
                                                    : counters.units_refused;
  ++units;
  if (verdict == Verdict::kDuplicate && job != nullptr && HasForm(*job, returned))
    counters.samples_wasted += PixelSamples(*returned.tile);
  counters.waste_s += returned.render_seconds;
  if (job != nullptr) job->clock.waste_s += returned.render_seconds;
}

void ResultAcceptance::NoteSuspects() {
  for (const WorkerId worker : state_.scheduler.TakeDistrusted()) {
    for (const JobId id : state_.jobs.open()) {
      JobResults& results = state_.jobs.At(id).results;
      const auto merged = results.unconfirmed.extract(worker);
      if (merged.empty()) continue;
      results.units_suspect += merged.mapped();
      state_.output.facts.emplace_back(CountsOf(state_.jobs.At(id)));
      state_.output.log.push_back(fmt::format("results_suspect job={} worker={:016x} units={}", Number(id),
                                              Number(worker), merged.mapped()));
      state_.AddMessage(
          MessageLevel::kWarning, id,
          fmt::format("{} units in the picture came from a worker whose results later proved wrong",
                      merged.mapped()));
    }
  }
}

UnitsCounted CountsOf(const Job& job) {
  return {job.id, job.results.units_verified, job.results.units_disputed, job.results.units_suspect};
}

}  // namespace tessera
