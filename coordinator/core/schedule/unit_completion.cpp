#include "coordinator/core/schedule/unit_completion.h"

#include <fmt/format.h>

#include <limits>

#include "renderer/util/check.h"

namespace tessera {

bool UnitCompletion::Finish(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                            double render_seconds) {
  TESSERA_CHECK(state_.jobs.IsKnown(unit));
  ActiveFrame& frame = *state_.jobs.FindFrame(unit);
  EndLease(now, worker, lease, unit);
  if (!frame.work.Finish({unit.tile, unit.range})) return false;
  Credit(worker, frame, unit, render_seconds);
  failures_.Disprove(worker, unit, frame);
  if (!state_.losses.empty()) {
    state_.losses.Rendered({frame.scene.key, unit.job, unit.frame, unit.tile}, [&](SampleRange range) {
      return frame.work.IsDone({unit.tile, range});
    });
  }
  DropDoneLeases(frame, unit);
  Retire(state_.jobs.At(unit.job), unit.frame);
  return true;
}

// The worker has done what the lease asked for.
void UnitCompletion::EndLease(Instant now, WorkerId id, LeaseId lease, const WorkUnit& unit) {
  const LeaseRecord* const held = state_.leases.Find(lease);
  if (held != nullptr && held->worker == id && held->lease.unit == unit) leases_.End(lease);
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr) return;
  worker->last_contact = now;
  state_.leases.StartNext(now, id);
}

// Learns from a result how fast the worker is and what the tile costs.
void UnitCompletion::Credit(WorkerId id, ActiveFrame& frame, const WorkUnit& unit, double render_seconds) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr) return;
  WorkerRoster::CreditUnit(*worker);
  if (render_seconds <= 0) return;
  const TileSamples samples{unit.tile, unit.range};
  if (const auto cost = frame.work.Cost(samples); cost && *cost > 0)
    state_.workers.MeasureSpeed(*worker, *cost, render_seconds, frame.work.IsMeasured(unit.tile));
  frame.work.RecordCost(samples, render_seconds * worker->speed);
  JobSchedule& schedule = state_.jobs.At(unit.job).schedule;
  schedule.measured_cost += render_seconds * worker->speed;
  schedule.measured_samples += static_cast<double>(frame.work.PixelCount(unit.tile)) * unit.range.size;
}

// Drops the leases of samples that are all done. Only leases that overlap the unit can have become so.
void UnitCompletion::DropDoneLeases(const ActiveFrame& frame, const WorkUnit& unit) {
  std::vector<LeaseId> done;
  for (const auto& [lease, range] : state_.leases.OfTile(unit)) {
    if (range.Overlaps(unit.range) && frame.work.IsDone({unit.tile, range})) done.push_back(lease);
  }
  for (const LeaseId lease : done) leases_.DropDone(lease);
}

void UnitCompletion::Retire(Job& job, uint32_t frame) {
  if (!job.schedule.active.at(frame).work.Complete()) return;
  job.schedule.active.erase(frame);
  state_.leases.ForgetFrame(job.id, frame);
  // There is room for another frame, perhaps of another job.
  if (state_.jobs.ClearRefusal() || !job.schedule.ahead.empty()) state_.idle.UnblockAll();
}

void UnitCompletion::SetGoal(Job& job, uint32_t index, uint32_t tile, const TileGoal& goal) {
  const auto active = job.schedule.active.find(index);
  if (active == job.schedule.active.end()) return;
  if (active->second.work.SetGoal(tile, goal)) state_.idle.UnblockAll();
  if (!goal.is_final) return;
  constexpr SampleRange kAll{0, std::numeric_limits<uint32_t>::max()};
  DropDoneLeases(active->second, {job.id, index, tile, kAll});
  Retire(job, index);
}

VoteOutcome UnitCompletion::RecordVote(Instant now, WorkerId id, LeaseId lease, const WorkUnit& unit,
                                       double render_seconds, const Digest& result) {
  ActiveFrame& frame = *state_.jobs.FindFrame(unit);
  const TileSamples samples{unit.tile, unit.range};
  // Finish recognizes it as a duplicate.
  if (frame.work.IsDone(samples)) return {VoteOutcome::Kind::kAccepted, {}, false};
  if (!votes_.JoinVerification(frame, samples)) {
    if (state_.leases.IsHeldBy(lease, id)) leases_.Return(lease);
    return {};
  }
  EndLease(now, id, lease, unit);
  const WorkerRecord* const worker = state_.workers.Find(id);
  const std::string name = worker != nullptr ? worker->name : fmt::format("{:016x}", Number(id));
  const uint64_t machine = worker != nullptr ? worker->machine : 0;
  VoteOutcome outcome = votes_.RecordVote(unit, {id, name, result, machine});
  if (outcome.kind == VoteOutcome::Kind::kHeld) {
    Credit(id, frame, unit, render_seconds);
    state_.losses.Rendered({frame.scene.key, unit.job, unit.frame, unit.tile}, [&](SampleRange range) {
      return range.begin >= unit.range.begin && range.end() <= unit.range.end();
    });
  }
  return outcome;
}

void UnitCompletion::RestoreDone(JobId id, uint32_t index, TileSamples samples) {
  ActiveFrame* const frame = state_.jobs.FindOrBegin({id, index, samples.tile, samples.range});
  if (frame == nullptr) return;
  frame->work.Finish(samples);
  if (frame->work.Complete()) state_.jobs.At(id).schedule.active.erase(index);
}

}  // namespace tessera
