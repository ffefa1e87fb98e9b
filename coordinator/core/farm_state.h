// What the parts of the farm work on together.
#pragma once

#include <chrono>
#include <string>

#include "coordinator/core/farm_output.h"
#include "coordinator/core/job_table.h"
#include "coordinator/core/kept_sums.h"
#include "coordinator/core/membership_ledger.h"
#include "coordinator/core/schedule/scheduler.h"

namespace tessera {

struct FarmState {
  FarmState(SchedulerOptions options, uint64_t kept_bytes_max, FarmId farm)
      : id(farm),
        epoch(options.epoch),
        scheduler(options),
        kept_sums(kept_bytes_max),
        membership(output.facts) {}

  const FarmId id;
  uint32_t epoch;
  JobTable jobs;
  Scheduler scheduler;
  KeptSums kept_sums;
  std::chrono::milliseconds since_1970{};  // of Instant{0}
  std::string storage_reason;              // why the journal or the spool cannot be written now, or empty
  FarmOutput output;
  MembershipLedger membership;

  // Times of facts: every process has its own Instant{0}.
  int64_t UnixTime_ms(Instant at) const {
    return (since_1970 + std::chrono::duration_cast<std::chrono::milliseconds>(at)).count();
  }

  void AddMessage(MessageLevel level, JobId job, std::string text) {
    output.messages.push_back({job, level, std::move(text)});
  }
};

}  // namespace tessera
