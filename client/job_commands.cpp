// tessera status, watch, cancel, extend: commands about one job.
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

}  // namespace

Result<int> RunStatus(const Options& options, Cancellation& cancellation) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto status = (*client)->Status(JobId{options.job});
  if (!status) return status.error();
  Print(options, *status);
  if (!options.json) fmt::print("{}", TimesTable(status->times));
  return 0;
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
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto status = (*client)->Cancel(JobId{options.job});
  if (!status) return status.error();
  Print(options, *status);
  return 0;
}

Result<int> RunExtend(const Options& options, Cancellation& cancellation) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto status = (*client)->Extend(JobId{options.job}, *options.render.samples_per_pixel);
  if (!status) return status.error();
  Print(options, *status);
  return 0;
}

}  // namespace tessera
