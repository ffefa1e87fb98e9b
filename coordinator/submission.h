// Checks that a submitted job can be rendered with the blobs that are stored.
#pragma once

#include <grpcpp/support/status.h>

#include <chrono>
#include <functional>

#include "coordinator/missing_blobs.h"
#include "coordinator/task_pool.h"
#include "proto/blobs/blob_store.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

// An error, naming the first file: kBadInput if the package lacks a scene file of the job or if a frame
// cannot be denoised as it asks for, kFailed if a blob is missing or corrupt, kInterrupted if reading the
// files takes longer than `patience`. Looks at every file, and reads those that were not used since the
// start.
Result<void> CheckSubmission(const JobSpec& spec, const BlobStore& blobs,
                             std::chrono::steady_clock::duration patience = kFileChecksMax);

// Runs `check`, which checks a job of this scene package, on a thread for brief tasks if no file has to be
// read for it, and on one for lengthy tasks otherwise. The store must outlive the threads.
void PostCheck(FileThreads& threads, const BlobStore& blobs, const Digest& package,
               std::function<void()> check);

// Whether the coordinator can make the pictures of these frames.
Result<void> CheckFrames(const std::vector<FrameRequest>& frames);

// The same as CheckSubmission for a job whose frames a worker is to make.
Result<void> CheckOrder(const SceneOrder& order, const BlobStore& blobs,
                        std::chrono::steady_clock::duration patience = kFileChecksMax);

// The status of a call whose job does not pass one of these checks. If the check takes too long, the caller
// tries again.
grpc::Status NotRenderable(const Error& error);
// The status of a call whose job the farm does not admit.
grpc::Status NotAdmitted(const Error& error);

}  // namespace tessera
