// Fetches the pictures of a job from a farm into files here.
#pragma once

#include <vector>

#include "client/coordinator/coordinator_client.h"
#include "client/picture_names.h"
#include "client/saved_picture.h"
#include "renderer/util/result.h"

namespace tessera {

// Fetches each picture once. Not thread safe.
class FrameFetcher {
 public:
  FrameFetcher(CoordinatorClient& client, JobId job, PictureNames names)
      : client_(client), job_(job), names_(std::move(names)) {}

  // Saves every picture that is finished and has not been saved yet.
  Result<void> SaveFinished();
  // Saves a finished frame, given by its index in the job. A file that already has the right bytes is left as
  // it is, and nothing is transferred.
  Result<void> Save(size_t index, const FrameStatus& frame);
  // Saves what has been rendered so far of a frame that is not finished.
  Result<void> SavePreview(size_t index, int frame);
  const std::vector<SavedPicture>& saved() const { return saved_; }

 private:
  Result<void> Fetch(size_t index, int frame, bool preview);

  CoordinatorClient& client_;
  JobId job_;
  PictureNames names_;
  std::vector<bool> is_saved_;  // by index
  std::vector<SavedPicture> saved_;
};

}  // namespace tessera
