// Fetches the pictures of a job from a farm into files here.
#pragma once

#include <stop_token>
#include <string_view>
#include <vector>

#include "client/coordinator/coordinator_client.h"
#include "client/picture_names.h"
#include "client/saved_picture.h"
#include "renderer/util/result.h"

namespace tessera {

// Fetches each picture once. Not thread safe.
class FrameFetcher {
 public:
  // `stop` as in WriteOutput.
  FrameFetcher(CoordinatorClient& client, JobId job, PictureNames names, std::stop_token stop,
               IfUnsaved if_unsaved = IfUnsaved::kFail)
      : client_(client),
        job_(job),
        names_(std::move(names)),
        stop_(std::move(stop)),
        if_unsaved_(if_unsaved) {}

  // Saves every picture that is finished and has not been saved yet.
  Result<void> SaveFinished();
  // Saves a finished frame, given by its index in the job. A file that already has the right bytes is left as
  // it is, and nothing is transferred.
  Result<void> Save(size_t index, const FrameStatus& frame);
  // Saves what has been rendered so far of a frame that is not finished. Returns false if its job ended
  // before anything was rendered of it.
  Result<bool> SavePreview(size_t index, int frame);
  const std::vector<SavedPicture>& saved() const { return saved_; }

 private:
  Result<void> Keep(std::string_view exr, int frame);

  CoordinatorClient& client_;
  JobId job_;
  PictureNames names_;
  std::stop_token stop_;
  IfUnsaved if_unsaved_;
  std::vector<bool> is_saved_;  // by index
  std::vector<SavedPicture> saved_;
};

}  // namespace tessera
