// tessera watch
#include <fmt/format.h>

#include <algorithm>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/default_job.h"
#include "client/commands/live_options.h"
#include "client/commands/option_groups.h"
#include "client/commands/status_text.h"
#include "client/commands/watching.h"
#include "client/notify_command.h"
#include "client/screen.h"
#include "proto/shell/console.h"

namespace tessera {
namespace {

struct WatchOptions {
  std::vector<JobId> jobs;  // empty: the default job
  ConnectionOptions connection;
  LiveOptions live;
  bool picture = false;
  std::string notify_command;
  bool json = false;
};

void AddWatchFlags(CLI::App& app, WatchOptions& options) {
  AddJobsArgument(app, options.jobs);
  AddConnectionFlags(app, options.connection);
  AddSwitch(app, "--picture", "Draw the picture into the terminal while it is rendered, until q is pressed",
            options.picture);
  AddLiveFlags(app, options.live);
  AddNotifyFlag(app, options.notify_command);
  AddJsonFlag(app, options.json);
}

Result<void> CheckWatch(const WatchOptions& options) {
  if (options.jobs.size() > 1 && (options.picture || options.live.any()))
    return BadInput("--picture, --preview and --display show the picture of one job");
  return CheckLive(options.live);
}

// Returns nullopt if the user stops watching.
Result<std::optional<JobStatus>> Follow(const WatchOptions& options, Cancellation& cancellation) {
  const JobId job = options.jobs.front();
  if (options.picture && Screen::IsAvailable())
    return WatchPicture(job, options.connection, options.live, cancellation);
  if (options.picture) PrintNote("tessera: there is no terminal for --picture\n");
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  auto status = WatchWithViews(**client, job, options.connection, options.live, cancellation);
  if (!status) return status.error();
  return std::optional(std::move(*status));
}

Result<int> WatchOne(const WatchOptions& options, Cancellation& cancellation) {
  const auto followed = Follow(options, cancellation);
  if (!followed) return followed.error();
  const std::optional<JobStatus>& status = *followed;
  if (!status) {
    PrintNote("job {} continues\n", Number(options.jobs.front()));
    return 0;
  }
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

Result<int> WatchDefault(WatchOptions options, Cancellation& cancellation) {
  {
    const auto client = Connect(options.connection, cancellation);
    if (!client) return client.error();
    const auto job = ChooseJob(**client, options.connection, std::nullopt);
    if (!job) return job.error();
    options.jobs = {*job};
  }
  return WatchOne(options, cancellation);
}

Result<int> RunWatch(const WatchOptions& options, Cancellation& cancellation) {
  if (options.jobs.empty()) return WatchDefault(options, cancellation);
  return options.jobs.size() == 1 ? WatchOne(options, cancellation) : WatchSeveral(options, cancellation);
}

}  // namespace

Command WatchCommand() {
  return MakeCommand<WatchOptions>({
      .name = "watch",
      .summary = "Follow the progress of jobs until they end",
      .examples = {{"Follow your job until it ends", "tessera watch"},
                   {"Follow job 12 until it ends", "tessera watch 12"},
                   {"Follow three jobs", "tessera watch 12 13 14"},
                   {"Look at the picture of job 12 in the terminal", "tessera watch 12 --picture"}},
      .add_flags = AddWatchFlags,
      .check = CheckWatch,
      .run = RunWatch,
  });
}

}  // namespace tessera
