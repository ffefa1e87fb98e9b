// tessera status, watch, cancel, pause, resume, priority, extend: commands about one job.
#include <fmt/format.h>

#include "client/commands.h"
#include "client/reach_coordinator.h"
#include "client/status_text.h"
#include "client/times_text.h"
#include "client/watching.h"

namespace tessera {
namespace {

void Print(const Options& options, const JobStatus& status) {
  fmt::print("{}\n", options.json ? JobJson(status) : JobText(status));
}

// Asks the coordinator one thing about the job and prints the status that it answers.
template <typename Ask>
Result<int> PrintAnswer(const Options& options, Cancellation& cancellation, Ask ask) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto status = ask(**client, JobId{options.job});
  if (!status) return status.error();
  Print(options, *status);
  if (!options.json) fmt::print("{}", TimesTable(status->times));
  return 0;
}

}  // namespace

Result<int> RunStatus(const Options& options, Cancellation& cancellation) {
  return PrintAnswer(options, cancellation,
                     [](CoordinatorClient& client, JobId job) { return client.Status(job); });
}

Result<int> RunWatch(const Options& options, Cancellation& cancellation) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto status = WatchWithProgress(**client, JobId{options.job});
  if (!status) return status.error();
  Print(options, *status);
  if (status->state != JobState::kFinished) return EndedWithoutPicture(*status);
  return 0;
}

Result<int> RunCancel(const Options& options, Cancellation& cancellation) {
  return PrintAnswer(options, cancellation,
                     [](CoordinatorClient& client, JobId job) { return client.Cancel(job); });
}

Result<int> RunPause(const Options& options, Cancellation& cancellation) {
  return PrintAnswer(options, cancellation,
                     [](CoordinatorClient& client, JobId job) { return client.Pause(job); });
}

Result<int> RunResume(const Options& options, Cancellation& cancellation) {
  return PrintAnswer(options, cancellation,
                     [](CoordinatorClient& client, JobId job) { return client.Resume(job); });
}

Result<int> RunPriority(const Options& options, Cancellation& cancellation) {
  return PrintAnswer(options, cancellation, [&](CoordinatorClient& client, JobId job) {
    return client.SetPriority(job, options.priority);
  });
}

Result<int> RunExtend(const Options& options, Cancellation& cancellation) {
  return PrintAnswer(options, cancellation, [&](CoordinatorClient& client, JobId job) {
    return client.Extend(job, *options.render.samples_per_pixel);
  });
}

}  // namespace tessera
