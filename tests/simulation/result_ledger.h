// What workers were told is accepted, to be held against what the farm has rendered afterwards.
#pragma once

#include <map>
#include <set>
#include <tuple>

#include "coordinator/core/schedule/sample_set.h"
#include "proto/terms.h"

namespace tessera {

class ResultLedger {
 public:
  void Acknowledge(const WorkUnit& unit) { samples_[{unit.job, unit.frame, unit.tile}].Add(unit.range); }
  // Whether any of the unit's samples was acknowledged.
  bool Holds(const WorkUnit& unit) const {
    const auto found = samples_.find({unit.job, unit.frame, unit.tile});
    return found != samples_.end() && found->second.Overlaps(unit.range);
  }
  // Whether the lease has not been seen before.
  bool IsNew(LeaseId lease) { return leases_.insert(lease).second; }

 private:
  std::map<std::tuple<JobId, uint32_t, uint32_t>, SampleSet> samples_;
  std::set<LeaseId> leases_;
};

}  // namespace tessera
