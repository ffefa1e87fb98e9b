// Watching a job.
#pragma once

#include <functional>

#include "client/coordinator/coordinator_client.h"

namespace tessera {

// Shows the job's progress on stderr until it has ended. Returns its last status. Calls `on_status`, if
// given, with each status on the way.
Result<JobStatus> WatchWithProgress(CoordinatorClient& client, JobId job,
                                    const std::function<void(const JobStatus&)>& on_status = {});

// The error of a command whose job failed or was cancelled.
Error EndedWithoutPicture(const JobStatus& status);

}  // namespace tessera
