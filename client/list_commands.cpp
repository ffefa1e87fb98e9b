// tessera jobs, workers: what a farm does.
#include <fmt/format.h>

#include "client/commands.h"
#include "client/reach_coordinator.h"
#include "client/status_text.h"

namespace tessera {

Result<int> RunJobs(const Options& options, Cancellation& cancellation) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto jobs = (*client)->Jobs();
  if (!jobs) return jobs.error();
  fmt::print("{}", options.json ? JobsJson(*jobs) + "\n" : JobTable(*jobs));
  return 0;
}

Result<int> RunWorkers(const Options& options, Cancellation& cancellation) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto workers = (*client)->Workers();
  if (!workers) return workers.error();
  fmt::print("{}", options.json ? WorkersJson(*workers) + "\n" : WorkerTable(*workers));
  return 0;
}

}  // namespace tessera
