// The tail of a job: nothing is open any more, some workers are idle, others are late. Units that wait at a
// slow worker are moved; those that run are split and rendered a second time (backup tasks: Dean and Ghemawat
// 2004, section 3.6).
#include <algorithm>
#include <deque>

#include "coordinator/core/policy.h"
#include "coordinator/core/scheduler.h"

namespace tessera {
namespace {

// When a unit that is late may be there: it has been late for some time, so it may be for as long again.
Instant LikelyEnd(Instant now, const LeaseRecord& record) {
  return record.expected_end > now ? record.expected_end : now + (now - record.expected_end);
}

constexpr size_t kCandidatesPerSlot = 4;  // looked at for each idle slot: some are not for it
constexpr int kAttemptsMax = 20'000;      // to give a unit to a worker, in one round: some milliseconds

}  // namespace

// As far as one can guess.
bool Scheduler::HasStarted(Instant now, const LeaseRecord& record) {
  return record.started || record.expected_start <= now + FromSeconds(kHandoverDuration_s);
}

void Scheduler::RelieveTail(Instant now) {
  if (now < tail_due_ || starved_.empty() || leases_.empty()) return;
  tail_due_ = now + kTailInterval;
  const auto idle_slots_of = [](const WorkerRecord& worker) {
    return worker.slots - static_cast<int>(worker.leases.size());
  };
  std::deque<WorkerRecord*> helpers;
  int idle_slots = 0;
  for (const WorkerId id : starved_) {
    WorkerRecord& worker = workers_.at(id);
    if (idle_slots_of(worker) <= 0) continue;
    helpers.push_back(&worker);
    idle_slots += idle_slots_of(worker);
  }
  if (helpers.empty()) return;
  std::stable_sort(helpers.begin(), helpers.end(),
                   [](const auto* a, const auto* b) { return a->speed > b->speed; });
  int attempts = 0;
  for (const LeaseId slow : SlowestUnits(now, static_cast<size_t>(idle_slots) * kCandidatesPerSlot)) {
    for (size_t h = 0; h < helpers.size() && leases_.contains(slow) && attempts < kAttemptsMax; ++attempts) {
      WorkerRecord& helper = *helpers[h];
      const Relief relief = Relieve(now, helper, slow, idle_slots);
      if (relief == Relief::kUseless) break;
      if (relief == Relief::kUnfit) {
        ++h;
      } else if (idle_slots_of(helper) <= 0) {
        helpers.erase(helpers.begin() + static_cast<std::ptrdiff_t>(h));
      }
    }
  }
}

std::vector<LeaseId> Scheduler::SlowestUnits(Instant now, size_t count_max) const {
  std::vector<std::pair<Instant, LeaseId>> units;
  units.reserve(leases_.size());
  for (const auto& [id, record] : leases_) units.emplace_back(LikelyEnd(now, record), id);
  const auto later = [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a < b;
  };
  const size_t count = std::min(count_max, units.size());
  std::partial_sort(units.begin(), units.begin() + static_cast<std::ptrdiff_t>(count), units.end(), later);
  std::vector<LeaseId> slowest;
  for (size_t i = 0; i < count; ++i) slowest.push_back(units[i].second);
  return slowest;
}

// Gives the helper the slow unit or a part of it, if that promises to end it sooner.
Scheduler::Relief Scheduler::Relieve(Instant now, WorkerRecord& helper, LeaseId slow, int idle_slots) {
  const LeaseRecord& record = leases_.at(slow);
  const WorkUnit unit = record.lease.unit;
  JobRecord& job = jobs_.at(unit.job);
  FrameRecord& frame = job.frames.at(unit.frame);
  if (job.paused || !helper.HasTags(job.spec->required_tags)) return Relief::kUnfit;
  if (record.worker == helper.id || !helper.HasReady(frame.scene.key)) return Relief::kUnfit;
  if (!frame.failures.May(helper.id, unit.tile)) return Relief::kUnfit;
  const TileSamples samples{unit.tile, unit.range};
  if (frame.verification.IsOnTrial(samples) && !frame.verification.Admits(samples, helper.id))
    return Relief::kUnfit;
  const double remaining_s = Seconds(LikelyEnd(now, record) - now);
  const double whole_s = record.cost ? *record.cost / helper.speed : kUnknownUnitDuration_s;
  WorkUnit taken = unit;
  if (HasStarted(now, record)) {
    const auto piece = PieceFor(record, frame, whole_s, idle_slots);
    if (!piece) return Relief::kUseless;
    const double piece_s = whole_s * piece->size / unit.range.size;
    if (remaining_s < kBackupGain * (piece_s + kHandoverDuration_s)) return Relief::kUseless;
    taken.range = *piece;
  } else {
    if (remaining_s < kStealGain * (whole_s + kHandoverDuration_s)) return Relief::kUseless;
    Revoke(workers_.at(record.worker), slow);
    Forget(slow);
  }
  Grant(now, helper, job, frame, taken, NextLease());
  return Relief::kGiven;
}

// A part of the straggler's range that nobody else works on yet: as many parts as slots are idle, or smaller
// ones where others have left gaps.
std::optional<SampleRange> Scheduler::PieceFor(const LeaseRecord& slow, const FrameRecord& frame,
                                               double whole_s, int idle_slots) const {
  const WorkUnit& unit = slow.lease.unit;
  const auto& leases = frame.leases.at(unit.tile);
  // A unit that is verified stays whole, and no piece becomes one.
  const bool is_on_trial = frame.verification.IsOnTrial({unit.tile, unit.range});
  const auto is_free = [&](SampleRange piece) {
    if (frame.work.HasDone({unit.tile, piece})) return false;
    if (!is_on_trial && frame.verification.IsChosen({unit.tile, piece})) return false;
    const auto copies = std::count_if(leases.begin(), leases.end(),
                                      [&](const auto& each) { return each.second.Overlaps(piece); });
    return copies < kCopiesMax;
  };
  const double shortest_s = std::min(whole_s, kUnitDurationMin_s);
  const int pieces_max = is_on_trial ? 1 : kSplitMax;
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
