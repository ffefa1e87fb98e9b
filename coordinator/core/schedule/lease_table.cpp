#include "coordinator/core/schedule/lease_table.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/util/check.h"

namespace tessera {

bool LeaseRecord::HasProbablyStarted(Instant now) const {
  return has_started || expected_start <= now + FromSeconds(kHandoverDuration_s);
}

Instant LeaseRecord::LikelyEnd(Instant now) const {
  return expected_end > now ? expected_end : now + (now - expected_end);
}

bool LeaseTable::MayHaveGiven(LeaseId id) const {
  return id.session != session_ || id.number < next_;
}

bool LeaseTable::MayHaveBeen(LeaseId id, WorkerId worker, const WorkUnit& unit) const {
  if (const auto held = records_.find(id); held != records_.end())
    return held->second.worker == worker && held->second.lease.unit == unit;
  if (!IsOurs(id)) return id.number > uint64_t{1} << kLeasesPerEpochBits && id.number < first_;
  const size_t place = id.number % kEndedKept;
  if (place >= ended_.size()) return false;
  const EndedLease& ended = ended_[place];
  return ended.id == id && ended.worker == worker && ended.unit == unit;
}

double LeaseTable::Queue::Seconds(double speed) const {
  return cost / speed + unknown * kUnknownUnitDuration_s;
}

LeaseRecord& LeaseTable::Add(Instant now, const Holder& holder, Lease lease, std::optional<double> cost) {
  const LeaseId id = lease.id;
  Queue& queue = queues_[holder.worker];
  const bool starts_now = queue.leases.size() < static_cast<size_t>(holder.slots);
  if (starts_now) queue.started = std::max(queue.started, id);
  LeaseRecord& record = records_[id];
  record.lease = std::move(lease);
  record.worker = holder.worker;
  record.cost = cost;
  record.deadline = now + kLeaseUnlistedMax;
  record.expected_start = starts_now ? now : now + FromSeconds(queue.Seconds(holder.speed) / holder.slots);
  record.duration_s = cost ? *cost / holder.speed : kUnknownUnitDuration_s;
  record.expected_end = record.expected_start + FromSeconds(record.duration_s);
  AddToQueue(queue, record);
  AddToJob(jobs_[record.lease.unit.job], record);
  return record;
}

LeaseRecord LeaseTable::Remove(LeaseId id) {
  const auto found = records_.find(id);
  TESSERA_CHECK(found != records_.end());
  LeaseRecord record = std::move(found->second);
  records_.erase(found);
  if (IsOurs(id)) {
    const size_t place = id.number % kEndedKept;
    if (place >= ended_.size()) ended_.resize(place + 1);
    ended_[place] = {id, record.worker, record.lease.unit};
  }
  RemoveFromQueue(queues_.at(record.worker), record);
  RemoveFromJob(jobs_.at(record.lease.unit.job), record);
  return record;
}

// Ids grow, except those of leases that were taken over.
void LeaseTable::AddToQueue(Queue& queue, const LeaseRecord& record) {
  std::vector<LeaseId>& leases = queue.leases;
  leases.insert(std::ranges::upper_bound(leases, record.lease.id), record.lease.id);
  if (record.cost) {
    queue.cost += *record.cost;
  } else {
    ++queue.unknown;
  }
}

void LeaseTable::RemoveFromQueue(Queue& queue, const LeaseRecord& record) {
  std::erase(queue.leases, record.lease.id);
  queue.cost = queue.leases.empty() ? 0 : std::max(0.0, queue.cost - record.cost.value_or(0));
  if (!record.cost) --queue.unknown;
}

void LeaseTable::AddToJob(JobLeases& job, const LeaseRecord& record) {
  const Lease& lease = record.lease;
  ++job.share.leases;
  ++job.share.holders[record.worker];
  job.share.seconds += record.duration_s;
  std::vector<std::vector<LeasedRange>>& tiles = job.frames[lease.unit.frame];
  if (tiles.size() <= lease.unit.tile) tiles.resize(lease.unit.tile + size_t{1});
  std::vector<LeasedRange>& ranges = tiles[lease.unit.tile];
  ranges.insert(std::ranges::upper_bound(ranges, lease.id, {}, &LeasedRange::lease),
                {lease.id, lease.unit.range});
}

void LeaseTable::RemoveFromJob(JobLeases& job, const LeaseRecord& record) {
  const WorkUnit& unit = record.lease.unit;
  JobShare& share = job.share;
  share.seconds = --share.leases == 0 ? 0 : std::max(0.0, share.seconds - record.duration_s);
  const auto holder = share.holders.find(record.worker);
  if (--holder->second == 0) share.holders.erase(holder);
  std::erase_if(job.frames.at(unit.frame)[unit.tile],
                [&](const LeasedRange& each) { return each.lease == record.lease.id; });
}

void LeaseTable::Renew(Instant now, LeaseRecord& record, const HeldLease& held) {
  record.is_listed = true;
  record.deadline = now + kLeaseDuration;
  if (held.stage == LeaseStage::kWaiting) return;
  const Instant duration = record.expected_end - record.expected_start;
  record.has_started = true;
  record.expected_start = now - held.stage_duration;
  record.expected_end = held.stage == LeaseStage::kRunning ? record.expected_start + duration : now;
}

LeaseRecord* LeaseTable::Find(LeaseId id) {
  const auto found = records_.find(id);
  return found == records_.end() ? nullptr : &found->second;
}

bool LeaseTable::IsHeldBy(LeaseId id, WorkerId worker) const {
  const auto found = records_.find(id);
  return found != records_.end() && found->second.worker == worker;
}

const LeaseTable::Queue& LeaseTable::QueueOf(WorkerId worker) const {
  static const Queue kNone;
  const auto found = queues_.find(worker);
  return found == queues_.end() ? kNone : found->second;
}

std::map<JobId, size_t> LeaseTable::UnitsOf(WorkerId worker) const {
  std::map<JobId, size_t> units;
  for (const LeaseId lease : OfWorker(worker)) ++units[At(lease).lease.unit.job];
  return units;
}

void LeaseTable::StartNext(Instant now, WorkerId worker) {
  const auto found = queues_.find(worker);
  if (found == queues_.end()) return;
  Queue& queue = found->second;
  for (auto next = std::ranges::upper_bound(queue.leases, queue.started); next != queue.leases.end();
       ++next) {
    LeaseRecord& record = records_.at(*next);
    queue.started = *next;
    if (record.has_started || record.expected_start <= now) continue;
    record.expected_end = now + (record.expected_end - record.expected_start);
    record.expected_start = now;
    return;
  }
}

const std::vector<LeaseTable::LeasedRange>& LeaseTable::OfTile(const WorkUnit& unit) const {
  static const std::vector<LeasedRange> kNone;
  const auto job = jobs_.find(unit.job);
  if (job == jobs_.end()) return kNone;
  const auto tiles = job->second.frames.find(unit.frame);
  const bool has_tile = tiles != job->second.frames.end() && unit.tile < tiles->second.size();
  return has_tile ? tiles->second[unit.tile] : kNone;
}

std::vector<LeaseId> LeaseTable::OfJob(JobId id) const {
  std::vector<LeaseId> all;
  const auto job = jobs_.find(id);
  if (job == jobs_.end()) return all;
  for (const auto& [frame, tiles] : job->second.frames) {
    for (const LeaseId lease : OfFrame(id, frame)) all.push_back(lease);
  }
  return all;
}

std::vector<LeaseId> LeaseTable::OfFrame(JobId id, uint32_t frame) const {
  std::vector<LeaseId> all;
  const auto job = jobs_.find(id);
  if (job == jobs_.end()) return all;
  const auto tiles = job->second.frames.find(frame);
  if (tiles == job->second.frames.end()) return all;
  for (const std::vector<LeasedRange>& ranges : tiles->second) {
    for (const LeasedRange& each : ranges) all.push_back(each.lease);
  }
  return all;
}

const LeaseTable::JobShare& LeaseTable::ShareOf(JobId id) const {
  static const JobShare kNone;
  const auto job = jobs_.find(id);
  return job == jobs_.end() ? kNone : job->second.share;
}

void LeaseTable::ForgetFrame(JobId id, uint32_t frame) {
  const auto job = jobs_.find(id);
  if (job != jobs_.end()) job->second.frames.erase(frame);
}

std::vector<LeaseId> LeaseTable::Expired(Instant now) const {
  std::vector<LeaseId> expired;
  for (const auto& [id, record] : records_) {
    if (now > record.deadline) expired.push_back(id);
  }
  std::ranges::sort(expired);
  return expired;
}

// By end and id, so the order in which records are looked at does not matter.
std::vector<LeaseId> LeaseTable::LastToEnd(Instant now, size_t count_max) const {
  std::vector<std::pair<Instant, LeaseId>> ends;
  ends.reserve(records_.size());
  for (const auto& [id, record] : records_) ends.emplace_back(record.LikelyEnd(now), id);
  const auto is_later = [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a < b;
  };
  const size_t count = std::min(count_max, ends.size());
  std::partial_sort(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(count), ends.end(), is_later);
  std::vector<LeaseId> last;
  for (size_t i = 0; i < count; ++i) last.push_back(ends[i].second);
  return last;
}

}  // namespace tessera
