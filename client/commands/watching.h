// Watching a job.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "client/cancellation.h"
#include "client/commands/live_options.h"
#include "client/commands/option_groups.h"
#include "client/coordinator/coordinator_client.h"

namespace tessera {

// Shows the job's progress on stderr until it has ended. Returns its last status. Calls `on_status`, if
// given, with each status on the way.
Result<JobStatus> WatchWithProgress(CoordinatorClient& client, JobId job,
                                    const std::function<void(const JobStatus&)>& on_status = {});

// The same, and shows the picture as `live` asks.
Result<JobStatus> WatchWithViews(CoordinatorClient& client, JobId job, const ConnectionOptions& connection,
                                 const LiveOptions& live, Cancellation& cancellation);

// Shows picture and progress on the whole terminal, besides what `live` asks, until the job has ended or q is
// pressed; then the last picture is left on the terminal. Returns nullopt if q was pressed.
Result<std::optional<JobStatus>> WatchPicture(JobId job, const ConnectionOptions& connection,
                                              const LiveOptions& live, Cancellation& cancellation);

// Shows the progress of several jobs until all have ended, over a connection for each. Returns their last
// statuses in the order of `jobs`. Calls `on_end`, if given, with each job that has ended, one after another.
Result<std::vector<JobStatus>> WatchAll(const ConnectionOptions& options, Cancellation& cancellation,
                                        const std::vector<JobId>& jobs,
                                        const std::function<void(const JobStatus&)>& on_end = {});

// The error of a command whose job failed or was cancelled.
Error EndedWithoutPicture(const JobStatus& status);

}  // namespace tessera
