// More samples for a job that runs or is finished. What is there stays: the sums of finished frames are in
// the spool, as nodes of the same trees, and merge with what is rendered from now on. Owned by the farm.
#pragma once

#include "coordinator/core/farm_state.h"

namespace tessera {

class JobExtension {
 public:
  explicit JobExtension(FarmState& state) : state_(state) {}
  // Every frame of the job gets `samples_per_pixel` samples. The error says why not. The job's sums must not
  // be moving.
  Result<void> Extend(Instant now, Job& job, uint32_t samples_per_pixel);
  // What a former process did.
  void Restore(Job& job, uint32_t samples_per_pixel);

 private:
  Result<void> Check(const Job& job, uint32_t samples_per_pixel) const;
  void ExtendFrames(Job& job, const JobSpec& spec);
  FarmState& state_;
};

}  // namespace tessera
