#include "coordinator/core/schedule/tail_relief.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

constexpr size_t kCandidatesPerSlot = 4;  // looked at for each idle slot: some do not fit
constexpr int kAttemptsMax = 20'000;      // to give a unit to a worker in one round: some milliseconds

}  // namespace

int TailRelief::IdleSlots(const WorkerRecord& worker) const {
  return worker.slots - static_cast<int>(state_.leases.OfWorker(worker.id).size());
}

// Blocked workers with idle slots, the fastest first.
std::deque<WorkerRecord*> TailRelief::Helpers() const {
  std::deque<WorkerRecord*> helpers;
  for (const WorkerId id : state_.idle.blocked()) {
    WorkerRecord& worker = state_.workers.At(id);
    if (IdleSlots(worker) > 0) helpers.push_back(&worker);
  }
  std::stable_sort(helpers.begin(), helpers.end(),
                   [](const auto* a, const auto* b) { return a->speed > b->speed; });
  return helpers;
}

void TailRelief::Relieve(Instant now) {
  if (now < due_ || state_.idle.blocked().empty() || state_.leases.empty()) return;
  due_ = now + kTailInterval;
  std::deque<WorkerRecord*> helpers = Helpers();
  int idle_slots = 0;
  for (const WorkerRecord* helper : helpers) idle_slots += IdleSlots(*helper);
  if (helpers.empty()) return;
  int attempts = 0;
  const size_t candidates = static_cast<size_t>(idle_slots) * kCandidatesPerSlot;
  for (const LeaseId slow : state_.leases.LastToEnd(now, candidates)) {
    size_t h = 0;
    for (; h < helpers.size() && state_.leases.Has(slow) && attempts < kAttemptsMax; ++attempts) {
      WorkerRecord& helper = *helpers[h];
      const Outcome outcome = RelieveBy(now, helper, slow, idle_slots);
      if (outcome == Outcome::kUseless) break;
      if (outcome == Outcome::kUnfit) {
        ++h;
      } else if (IdleSlots(helper) <= 0) {
        helpers.erase(helpers.begin() + static_cast<std::ptrdiff_t>(h));
      }
    }
  }
}

bool TailRelief::IsFit(Instant now, const WorkerRecord& helper, const LeaseRecord& slow) const {
  const WorkUnit& unit = slow.lease.unit;
  const Job& job = state_.jobs.At(unit.job);
  const ActiveFrame& frame = job.schedule.active.at(unit.frame);
  if (job.is_paused || !helper.has_tags(job.spec->required_tags)) return false;
  if (state_.losses.TrialOf(helper.id)) return false;
  if (slow.worker == helper.id || !helper.has_ready(frame.scene.key)) return false;
  if (!frame.failures.May(helper.id, unit.tile)) return false;
  const TileSamples samples{unit.tile, unit.range};
  if (!frame.verification.IsVerifying(samples)) return true;
  // Only a unit that has started stays with its holder as well.
  const auto besides = slow.HasProbablyStarted(now) ? std::nullopt : std::optional(slow.worker);
  return frame.verification.MayVote(samples, state_.VoterOf(helper), besides);
}

// Gives the helper the slow unit or a part of it if that promises to end it sooner.
TailRelief::Outcome TailRelief::RelieveBy(Instant now, WorkerRecord& helper, LeaseId slow, int idle_slots) {
  const LeaseRecord& record = state_.leases.At(slow);
  if (!IsFit(now, helper, record)) return Outcome::kUnfit;
  WorkUnit unit = record.lease.unit;
  Job& job = state_.jobs.At(unit.job);
  ActiveFrame& frame = job.schedule.active.at(unit.frame);
  const double remaining_s = Seconds(record.LikelyEnd(now) - now);
  const double whole_s = record.cost ? *record.cost / helper.speed : kUnknownUnitDuration_s;
  if (record.HasProbablyStarted(now)) {
    const auto piece = PieceFor(unit, frame, whole_s, idle_slots);
    if (!piece) return Outcome::kUseless;
    const double piece_s = whole_s * piece->size / unit.range.size;
    if (remaining_s < kBackupGain * (piece_s + kHandoverDuration_s)) return Outcome::kUseless;
    unit.range = *piece;
  } else {
    if (remaining_s < kStealGain * (whole_s + kHandoverDuration_s)) return Outcome::kUseless;
    state_.workers.Revoke(state_.workers.At(record.worker), slow);
    leases_.End(slow);
  }
  leases_.Grant(now, helper, job, frame, unit, state_.leases.NextId());
  return Outcome::kGiven;
}

// A part of the straggler's range that no other worker renders yet: as many parts as slots are idle, or
// smaller ones where others have left gaps.
std::optional<SampleRange> TailRelief::PieceFor(const WorkUnit& unit, const ActiveFrame& frame,
                                                double whole_s, int idle_slots) const {
  const auto& leases = state_.leases.OfTile(unit);
  // A unit that is verified stays whole, and no piece becomes one.
  const bool is_verifying = frame.verification.IsVerifying({unit.tile, unit.range});
  const auto is_free = [&](SampleRange piece) {
    if (frame.work.HasDone({unit.tile, piece})) return false;
    if (!is_verifying && frame.verification.IsChosen({unit.tile, piece})) return false;
    const auto copies = std::count_if(leases.begin(), leases.end(),
                                      [&](const auto& each) { return each.range.Overlaps(piece); });
    return copies < kCopiesMax;
  };
  const double shortest_s = std::min(whole_s, kUnitDurationMin_s);
  const int pieces_max = is_verifying ? 1 : kSplitMax;
  for (int pieces = 1; pieces <= pieces_max; pieces *= 2) {
    const uint32_t size = unit.range.size / static_cast<uint32_t>(pieces);
    if (size == 0 || whole_s / pieces < shortest_s) break;
    const bool finer_is_better = pieces * 2 <= std::min(idle_slots, pieces_max) && size > 1;
    if (finer_is_better && whole_s / (pieces * 2) >= shortest_s) continue;
    for (uint32_t end = unit.range.end(); end > unit.range.begin; end -= size) {
      if (is_free({end - size, size})) return SampleRange{end - size, size};
    }
  }
  return std::nullopt;
}

}  // namespace tessera
