// Following a job.
#pragma once

#include "farm/coordinator_client.h"
#include "util/digest.h"

namespace tessera {

// Shows the job's progress on stderr until it has ended; its last status.
Result<JobStatus> WatchWithProgress(CoordinatorClient& client, JobId job);

// The error that a job without a picture is: failed or cancelled.
Error EndedWithoutPicture(const JobStatus& status);

// {"output": ..., "sha256": ..., "seconds": ...}
std::string PictureJson(const std::string& path, const Digest& digest, double seconds);

}  // namespace tessera
