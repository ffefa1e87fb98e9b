// Following a job.
#pragma once

#include <functional>

#include "client/coordinator/coordinator_client.h"

namespace tessera {

// Shows the job's progress on stderr until it has ended; its last status. `on_status`, if there is one, hears
// of each status on the way.
Result<JobStatus> WatchWithProgress(CoordinatorClient& client, JobId job,
                                    const std::function<void(const JobStatus&)>& on_status = {});

// The error that a job without a picture is: failed or cancelled.
Error EndedWithoutPicture(const JobStatus& status);

}  // namespace tessera
