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
  const bool is_ours = Number(id) >> 32 == epoch_;
  return !is_ours || (Number(id) & 0xffffffff) < next_;
}

double LeaseTable::SecondsOf(const Queue& queue, double speed) {
  return queue.cost / speed + queue.unknown * kUnknownUnitDuration_s;
}

LeaseRecord& LeaseTable::Add(Instant now, const Holder& holder, Lease lease, std::optional<double> cost) {
  const LeaseId id = lease.id;
  Queue& queue = queues_[holder.worker];
  const bool starts_now = queue.leases.size() < static_cast<size_t>(holder.slots);
  if (starts_now) queue.started = std::max(queue.started, id);
  LeaseRecord& record = records_[id];
  record.worker = holder.worker;
  record.cost = cost;
  record.deadline = now + kLeaseUnlistedMax;
  record.expected_start = starts_now ? now : now + FromSeconds(SecondsOf(queue, holder.speed) / holder.slots);
  record.duration_s = cost ? *cost / holder.speed : kUnknownUnitDuration_s;
  record.expected_end = record.expected_start + FromSeconds(record.duration_s);
  if (cost) {
    queue.cost += *cost;
  } else {
    ++queue.unknown;
  }
  queue.leases.insert(id);
  tiles_[KeyOf(lease.unit)][id] = lease.unit.range;
  JobShare& share = shares_[lease.unit.job];
  ++share.leases;
  ++share.holders[holder.worker];
  share.seconds += record.duration_s;
  record.lease = std::move(lease);
  return record;
}

void LeaseTable::Remove(LeaseId id) {
  const auto found = records_.find(id);
  TESSERA_CHECK(found != records_.end());
  const LeaseRecord& record = found->second;
  Queue& queue = queues_.at(record.worker);
  queue.leases.erase(id);
  queue.cost = queue.leases.empty() ? 0 : std::max(0.0, queue.cost - record.cost.value_or(0));
  if (!record.cost) --queue.unknown;
  const WorkUnit& unit = record.lease.unit;
  const auto share = shares_.find(unit.job);
  if (--share->second.leases == 0) {
    shares_.erase(share);
  } else {
    const auto holder = share->second.holders.find(record.worker);
    if (--holder->second == 0) share->second.holders.erase(holder);
    share->second.seconds = std::max(0.0, share->second.seconds - record.duration_s);
  }
  const auto tile = tiles_.find(KeyOf(unit));
  tile->second.erase(id);
  if (tile->second.empty()) tiles_.erase(tile);
  records_.erase(found);
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

const std::set<LeaseId>& LeaseTable::OfWorker(WorkerId worker) const {
  static const std::set<LeaseId> kNone;
  const auto found = queues_.find(worker);
  return found == queues_.end() ? kNone : found->second.leases;
}

double LeaseTable::QueueSeconds(WorkerId worker, double speed) const {
  const auto found = queues_.find(worker);
  return found == queues_.end() ? 0 : SecondsOf(found->second, speed);
}

void LeaseTable::StartNext(Instant now, WorkerId worker) {
  const auto found = queues_.find(worker);
  if (found == queues_.end()) return;
  Queue& queue = found->second;
  for (auto next = queue.leases.upper_bound(queue.started); next != queue.leases.end(); ++next) {
    LeaseRecord& record = records_.at(*next);
    queue.started = *next;
    if (record.has_started || record.expected_start <= now) continue;
    record.expected_end = now + (record.expected_end - record.expected_start);
    record.expected_start = now;
    return;
  }
}

const std::map<LeaseId, SampleRange>& LeaseTable::OfTile(const WorkUnit& unit) const {
  static const std::map<LeaseId, SampleRange> kNone;
  const auto found = tiles_.find(KeyOf(unit));
  return found == tiles_.end() ? kNone : found->second;
}

std::vector<LeaseId> LeaseTable::OfJob(JobId job) const {
  std::vector<LeaseId> all;
  for (auto tile = tiles_.lower_bound({job, 0, 0}); tile != tiles_.end() && std::get<0>(tile->first) == job;
       ++tile) {
    for (const auto& [lease, range] : tile->second) all.push_back(lease);
  }
  return all;
}

const LeaseTable::JobShare& LeaseTable::ShareOf(JobId job) const {
  static const JobShare kNone;
  const auto found = shares_.find(job);
  return found == shares_.end() ? kNone : found->second;
}

std::vector<LeaseId> LeaseTable::Expired(Instant now) const {
  std::vector<LeaseId> expired;
  for (const auto& [id, record] : records_) {
    if (now > record.deadline) expired.push_back(id);
  }
  return expired;
}

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
