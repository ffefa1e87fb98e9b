// What the parts of the scheduler work on together. Each member is a part of its own, documented in its
// header.
#pragma once

#include <string>
#include <vector>

#include "coordinator/core/schedule/counters.h"
#include "coordinator/core/schedule/idle_workers.h"
#include "coordinator/core/schedule/job_message.h"
#include "coordinator/core/schedule/job_queue.h"
#include "coordinator/core/schedule/lease_table.h"
#include "coordinator/core/schedule/loss_book.h"
#include "coordinator/core/schedule/verification.h"
#include "coordinator/core/schedule/worker_roster.h"

namespace tessera {

// Seconds of slots that were spent on units of a job and given up.
struct GivenUpTime {
  JobId job{};
  double seconds = 0;
};

struct ScheduleState {
  ScheduleState(uint64_t session, uint32_t epoch) : leases(session, epoch) {}

  // On a farm of one machine none is preferred.
  bool IsOneMachine() const { return !awaits_workers && workers.is_one_machine(); }
  Voter VoterOf(const WorkerRecord& worker) const { return {worker.id, IsOneMachine() ? 0 : worker.machine}; }

  JobQueue jobs;
  WorkerRoster workers;
  LeaseTable leases;
  IdleWorkers idle;
  LossBook losses;
  bool awaits_workers = false;  // of a former process: they may return from other machines
  FarmCounters counters;
  std::vector<GivenUpTime> given_up;
  std::vector<std::string> log;  // "event key=value ..."
  std::vector<JobMessage> messages;

  void Warn(JobId job, std::string text) {
    messages.push_back({job, MessageLevel::kWarning, std::move(text)});
  }
};

}  // namespace tessera
