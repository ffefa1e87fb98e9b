// The end of jobs: finished, failed, cancelled and at last forgotten. Owned by the farm.
#pragma once

#include <string>

#include "coordinator/core/farm_state.h"

namespace tessera {

class JobEnd {
 public:
  explicit JobEnd(FarmState& state) : state_(state) {}
  // Does nothing if the job has ended already.
  void End(Instant now, Job& job, JobState end, const std::string& reason);
  // Removes the oldest ended jobs beyond kEndedJobsMax, and more while specifications take too much memory.
  void ForgetOldest();

 private:
  // Writes the pictures of frames that are not complete, so that what was rendered can be fetched.
  void KeepPictures(Job& job);
  void DropSums(const Job& job);
  FarmState& state_;
};

}  // namespace tessera
