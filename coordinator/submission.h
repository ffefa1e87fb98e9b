// Checks that a submitted job can be rendered with the blobs that are stored.
#pragma once

#include "proto/blobs/blob_store.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

// An error, naming the first file: kBadInput if the package lacks a scene file of the job or if a frame
// cannot be denoised as it asks for, kFailed if a blob is missing or corrupt. Looks at every file, and reads
// those that were not used since the start.
Result<void> CheckSubmission(const JobSpec& spec, const BlobStore& blobs);

// Whether the coordinator can make the pictures of these frames.
Result<void> CheckFrames(const std::vector<FrameRequest>& frames);

// The same as CheckSubmission for a job whose frames a worker is to make.
Result<void> CheckOrder(const SceneOrder& order, const BlobStore& blobs);

}  // namespace tessera
