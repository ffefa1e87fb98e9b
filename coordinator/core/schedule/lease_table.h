// All leases that are held: who holds what until when, and when it is expected to end. Pure bookkeeping with
// an index by worker, by tile and by job; it decides nothing. Owned by the scheduler. Every result looks up
// several leases, so lookups are hashed; all lists are ordered.
#pragma once

#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "coordinator/core/schedule/instant.h"
#include "proto/terms.h"

namespace tessera {

struct LeaseRecord {
  Lease lease;
  WorkerId worker{};
  std::optional<double>
      cost;               // in seconds on a worker of speed 1; nullopt if nothing of the frame is measured
  double duration_s = 0;  // expected when granted
  Instant deadline{};
  Instant expected_start{}, expected_end{};
  Instant announced_at{};
  bool is_announced = false;  // part of an answer that was given
  bool is_listed = false;     // by the worker's last state
  bool has_started = false;   // according to the worker's last state

  // Whether its holder is rendering it, as far as is known.
  bool HasProbablyStarted(Instant now) const;
  // A lease that was not announced waits for certain.
  bool IsWaiting(Instant now) const { return !is_announced || !HasProbablyStarted(now); }
  // When the unit may be done. One that is late has been late for some time, so it may be for as long again.
  Instant LikelyEnd(Instant now) const;
};

class LeaseTable {
 public:
  // The worker that gets a lease.
  struct Holder {
    WorkerId worker{};
    int slots = 1;
    double speed = 1;
  };
  // What a worker holds.
  struct Queue {
    std::vector<LeaseId> leases;  // in the order granted
    LeaseId started{};            // those up to here have started or are next, by estimate
    double cost = 0;              // of those whose cost is known
    int unknown = 0;              // leases whose cost is not known
    // How long a worker of this speed takes for all of them on one slot.
    double Seconds(double speed) const;
  };
  // Samples of a tile that a lease is for.
  struct LeasedRange {
    LeaseId lease{};
    SampleRange range;
  };
  // What a job has of the farm.
  struct JobShare {
    size_t leases = 0;
    double seconds = 0;                              // expected durations together
    std::unordered_map<WorkerId, uint32_t> holders;  // and how many leases each holds
  };

  // `session` differs for every process of any coordinator, so lease ids never meet again, also not when a
  // data directory is restored to an earlier state. `epoch` grows with every process that works on the
  // directory.
  LeaseTable(uint64_t session, uint32_t epoch)
      : session_(session), first_(uint64_t{epoch} << kLeasesPerEpochBits | 1), next_(first_) {}

  LeaseId NextId() { return {next_++, session_}; }
  // Whether this process or a former one may have given the id.
  bool MayHaveGiven(LeaseId id) const;
  // Whether the lease is or was one of this unit and this worker, as far as is known: former processes took
  // what they knew of theirs with them, and of leases that ended some kEndedKept are remembered.
  bool MayHaveBeen(LeaseId id, WorkerId worker, const WorkUnit& unit) const;

  // A new lease, the last in its holder's queue.
  LeaseRecord& Add(Instant now, const Holder& holder, Lease lease, std::optional<double> cost);
  // The lease must be there. Returns its last state.
  LeaseRecord Remove(LeaseId id);
  // The worker's state lists the lease.
  static void Renew(Instant now, LeaseRecord& record, const HeldLease& held);

  // Returns nullptr if there is no such lease.
  LeaseRecord* Find(LeaseId id);
  LeaseRecord& At(LeaseId id) { return records_.at(id); }
  const LeaseRecord& At(LeaseId id) const { return records_.at(id); }
  bool Has(LeaseId id) const { return records_.contains(id); }
  bool IsHeldBy(LeaseId id, WorkerId worker) const;
  size_t size() const { return records_.size(); }
  bool empty() const { return records_.empty(); }

  // ---- Of a worker ----
  const Queue& QueueOf(WorkerId worker) const;
  // In the order granted.
  const std::vector<LeaseId>& OfWorker(WorkerId worker) const { return QueueOf(worker).leases; }
  // The number of leases that it has of each job.
  std::map<JobId, size_t> UnitsOf(WorkerId worker) const;
  // One of the worker's slots became free: the first lease that waits starts now.
  void StartNext(Instant now, WorkerId worker);
  void ForgetWorker(WorkerId worker) { queues_.erase(worker); }

  // ---- Of a tile and a job ----
  // The oldest first.
  const std::vector<LeasedRange>& OfTile(const WorkUnit& unit) const;
  // By frame, tile and age.
  std::vector<LeaseId> OfJob(JobId job) const;
  // By tile and age.
  std::vector<LeaseId> OfFrame(JobId job, uint32_t frame) const;
  const JobShare& ShareOf(JobId job) const;
  // There are no leases of the frame and there will be none. The same of a job.
  void ForgetFrame(JobId job, uint32_t frame);
  void ForgetJob(JobId job) { jobs_.erase(job); }

  // ---- Of all ----
  std::vector<LeaseId> Expired(Instant now) const;
  // At most `count_max` leases that are likely to end last, the last first.
  std::vector<LeaseId> LastToEnd(Instant now, size_t count_max) const;

 private:
  struct JobLeases {
    JobShare share;
    std::map<uint32_t, std::vector<std::vector<LeasedRange>>> frames;  // by frame and tile
  };
  static void AddToQueue(Queue& queue, const LeaseRecord& record);
  static void RemoveFromQueue(Queue& queue, const LeaseRecord& record);
  static void AddToJob(JobLeases& job, const LeaseRecord& record);
  static void RemoveFromJob(JobLeases& job, const LeaseRecord& record);

  struct EndedLease {
    LeaseId id{};
    WorkerId worker{};
    WorkUnit unit;
  };
  // Some seconds of a large farm: what a lease that was lost leaves behind arrives within those.
  static constexpr size_t kEndedKept = size_t{1} << 16;
  // Ids order leases by age across epochs; at a million leases a second they last for 12 days, then ages of
  // different epochs mix while ids stay unique.
  static constexpr int kLeasesPerEpochBits = 40;
  bool IsOurs(LeaseId id) const { return id.session == session_; }

  uint64_t session_;
  uint64_t first_;  // of this process
  uint64_t next_;
  std::vector<EndedLease> ended_;  // a ring, by number
  std::unordered_map<LeaseId, LeaseRecord> records_;
  std::unordered_map<WorkerId, Queue> queues_;
  std::map<JobId, JobLeases> jobs_;
};

}  // namespace tessera
