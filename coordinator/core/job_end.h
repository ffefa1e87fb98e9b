// The end of jobs: finished, failed, cancelled and at last forgotten; and of frames that fail. Owned by the
// farm.
#pragma once

#include <string>

#include "coordinator/core/farm_state.h"

namespace tessera {

class JobEnd {
 public:
  explicit JobEnd(FarmState& state) : state_(state) {}
  // Does nothing if the job has ended already.
  void End(Instant now, Job& job, JobState end, const std::string& reason);
  // No worker can render the frame. The other frames of the job are still rendered, unless EndIfDecided ends
  // it.
  void FailFrame(Instant now, Job& job, uint32_t frame, const std::string& reason);
  // Ends the job if all its frames are finished or have failed, or if the others are given up because of
  // those that failed (kFailedFramesMax).
  void EndIfDecided(Instant now, Job& job);
  // Removes the oldest ended jobs beyond kEndedJobsMax, and more while specifications take too much memory.
  void ForgetOldest();

 private:
  // Writes the pictures of frames that are not complete, so that what was rendered can be fetched. Of one
  // frame: returns whether there is anything of it.
  void KeepPictures(Job& job);
  bool KeepPicture(const Job& job, uint32_t frame);
  // Of a frame that failed.
  void DropFrameSums(Job& job, uint32_t frame);
  void DropSums(const Job& job);
  FarmState& state_;
};

}  // namespace tessera
