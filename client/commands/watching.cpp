#include "client/commands/watching.h"

#include <fmt/format.h>

#include <algorithm>

#include "client/commands/status_text.h"

namespace tessera {

Result<JobStatus> WatchWithProgress(CoordinatorClient& client, JobId job,
                                    const std::function<void(const JobStatus&)>& on_status) {
  ProgressLine line("worker");
  uint32_t workers_most = 0;  // shown at the end, when none works for the job any more
  auto last = client.Watch(job, [&](const JobStatus& status) {
    workers_most = std::max(workers_most, status.workers);
    if (!HasEnded(status.state)) line.Show(ProgressOf(status));
    if (on_status) on_status(status);
  });
  if (!last) return last;
  Progress progress = ProgressOf(*last);
  progress.workers = std::max(progress.workers, static_cast<int>(workers_most));
  line.Finish(progress);
  return last;
}

Error EndedWithoutPicture(const JobStatus& status) {
  return Failed(fmt::format("job {} {}{}{}", Number(status.job),
                            status.state == JobState::kFailed ? "failed" : "was cancelled",
                            status.reason.empty() ? "" : ": ", status.reason));
}

}  // namespace tessera
