// Jobs whose frames a worker is to make, and which worker does. Such a job is a fact before anybody reads its
// scene; its frames are another. A worker has one preparation at a time, and of each owner one is done at a
// time, by priority. The first report whose frames match the order is accepted: the workers that render them
// read the scene again and refuse frames that differ. As with leases, what a worker does not list lapses and
// is given to another, which does not count as a failure. A worker fails a preparation if it lists it for
// longer than kPreparationDurationMax (a late report is still accepted), or if it is lost with it, unless it
// returns or others are lost at the same time (loss_book.h). As with units, three workers of three parties
// have to fail it before the job does; of fewer, if there are no others. Owned by the farm.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/farm_state.h"
#include "coordinator/core/job_end.h"

namespace tessera {

// Waiting for a worker, of one owner. More than anybody submits by hand.
constexpr size_t kOrdersPerOwnerMax = 100;

class Preparations {
 public:
  Preparations(FarmState& state, JobEnd& end, int attempts_max)
      : state_(state), end_(end), attempts_max_(attempts_max) {}

  // The jobs that wait after a start.
  void Begin();
  // Whether the owner may have another one.
  bool HasPlace(const JobOwner& owner) const;
  void Add(const Job& job);
  void Advance(Instant now);

  // What the worker has, as it lists it.
  void Synchronize(Instant now, const WorkerState& state);
  // Workers for which Take has a request.
  std::vector<WorkerId> News() const;
  // Returns the request to send to the worker, and counts it as sent; nullopt if there is none.
  std::optional<PreparationRequest> Take(Instant now, WorkerId worker);
  // Late reports and copies are harmless. Those of a worker in quarantine do not count.
  void Return(Instant now, WorkerId worker, const PreparationReport& report);

  struct Failure {
    std::string worker, reason;  // the name of the worker
    Party party;
  };

 private:
  struct Preparation {
    Digest key;
    std::optional<WorkerId> worker;  // that does it
    bool is_sent = false, is_listed = false;
    Instant sent_at{};
    Instant lapses_at{};                               // unless the worker lists it
    Instant listed_at{}, listed_for{};                 // at last, and how long altogether
    std::set<WorkerId> lapsed;                         // workers that did not list it
    std::vector<std::pair<WorkerId, Instant>> losses;  // not judged yet
    Instant rests_until{};                             // after a loss
    std::map<WorkerId, Failure> failures;
    // Whether the worker may not try again: it has failed, or its member with as many workers as count.
    bool IsClosedTo(WorkerId id, const Party& party, int attempts_max) const;
    bool HasFailed(const Party& party) const;
    Instant failed_at{};
  };
  Job* OpenJob(JobId id) const;
  void CountLosses(Instant now);
  bool IsOneOfCrowd(Instant at) const;
  void CheckWorker(Instant now, Job& job, Preparation& preparation);
  void JudgeLosses(Instant now, Job& job, Preparation& preparation);
  void Assign(Instant now);
  std::optional<WorkerId> WorkerFor(const Preparation& preparation, const std::set<WorkerId>& busy) const;
  void Fail(Instant now, Job& job, Preparation& preparation, WorkerId worker, const std::string& reason);
  bool HasFailedForAll(const Preparation& preparation) const;
  void FailHopeless(Instant now);
  void Admit(Instant now, Job& job, const PreparationReport& report);

  FarmState& state_;
  JobEnd& end_;
  const int attempts_max_;
  std::map<JobId, Preparation> open_;
  std::set<std::pair<WorkerId, Digest>> overdue_;  // that the workers still list, by their keys
  std::deque<std::pair<Instant, uint64_t>> lost_;  // when the number of workers lost became what
  Instant due_{};
};

}  // namespace tessera
