// tessera watch
#include <fmt/format.h>

#include <algorithm>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/option_groups.h"
#include "client/commands/status_text.h"
#include "client/commands/watching.h"
#include "client/notify_command.h"

namespace tessera {
namespace {

struct WatchOptions {
  std::vector<JobId> jobs;
  ConnectionOptions connection;
  std::string notify_command;
  bool json = false;
};

void AddWatchFlags(CLI::App& app, WatchOptions& options) {
  AddJobsArgument(app, options.jobs);
  AddConnectionFlags(app, options.connection);
  AddNotifyFlag(app, options.notify_command);
  AddJsonFlag(app, options.json);
}

Result<int> WatchOne(const WatchOptions& options, Cancellation& cancellation) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto status = WatchWithProgress(**client, options.jobs.front());
  if (!status) return status.error();
  fmt::print("{}\n", options.json ? JobJson(*status) : JobText(*status));
  std::fflush(stdout);
  RunNotifyCommand(options.notify_command, NoticeOf(*status));
  if (status->state != JobState::kFinished) return EndedWithoutPicture(*status);
  return 0;
}

Result<int> WatchSeveral(const WatchOptions& options, Cancellation& cancellation) {
  const auto all = WatchAll(options.connection, cancellation, options.jobs, [&](const JobStatus& status) {
    RunNotifyCommand(options.notify_command, NoticeOf(status));
  });
  if (!all) return all.error();
  if (options.json) {
    fmt::print("{}\n", JobsJson(*all));
  } else {
    for (const JobStatus& status : *all) fmt::print("{}\n", JobText(status));
  }
  const auto failed =
      std::ranges::find_if(*all, [](const JobStatus& status) { return status.state != JobState::kFinished; });
  if (failed != all->end()) return EndedWithoutPicture(*failed);
  return 0;
}

Result<int> RunWatch(const WatchOptions& options, Cancellation& cancellation) {
  return options.jobs.size() == 1 ? WatchOne(options, cancellation) : WatchSeveral(options, cancellation);
}

}  // namespace

Command WatchCommand() {
  return MakeCommand<WatchOptions>({
      .name = "watch",
      .summary = "Follow the progress of jobs until they end",
      .examples = {{"Follow job 12 until it ends", "tessera watch 12"},
                   {"Follow three jobs", "tessera watch 12 13 14"}},
      .add_flags = AddWatchFlags,
      .run = RunWatch,
  });
}

}  // namespace tessera
