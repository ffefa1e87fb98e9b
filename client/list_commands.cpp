// tessera jobs, workers, drain, release: what a farm does, and who works for it.
#include <fmt/format.h>

#include "client/commands.h"
#include "client/reach_coordinator.h"
#include "client/status_text.h"

namespace tessera {
namespace {

// Prints the workers that the coordinator answers with.
template <typename Ask>
Result<int> PrintWorkers(const Options& options, Cancellation& cancellation, Ask ask) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto workers = ask(**client);
  if (!workers) return workers.error();
  fmt::print("{}", options.json ? WorkersJson(*workers) + "\n" : WorkerTable(*workers));
  return 0;
}

}  // namespace

Result<int> RunJobs(const Options& options, Cancellation& cancellation) {
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto jobs = (*client)->Jobs();
  if (!jobs) return jobs.error();
  fmt::print("{}", options.json ? JobsJson(*jobs) + "\n" : JobTable(*jobs));
  return 0;
}

Result<int> RunWorkers(const Options& options, Cancellation& cancellation) {
  return PrintWorkers(options, cancellation, [](CoordinatorClient& client) { return client.Workers(); });
}

Result<int> RunDrain(const Options& options, Cancellation& cancellation) {
  return PrintWorkers(options, cancellation,
                      [&](CoordinatorClient& client) { return client.Drain(options.worker); });
}

Result<int> RunRelease(const Options& options, Cancellation& cancellation) {
  return PrintWorkers(options, cancellation,
                      [&](CoordinatorClient& client) { return client.Release(options.worker); });
}

}  // namespace tessera
