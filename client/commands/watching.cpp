#include "client/commands/watching.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>

#include "client/commands/connection.h"
#include "client/commands/status_text.h"
#include "client/live/farm_pictures.h"
#include "client/live/terminal_picture.h"
#include "client/progress_board.h"
#include "renderer/util/threads.h"

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

namespace {

LiveTitle TitleOf(JobId job, const std::vector<FrameStatus>& frames) {
  return {fmt::format("job {}", Number(job)), frames.size() > 1};
}

Result<void> AddFarmViews(LiveViews& views, CoordinatorClient& client, JobId job, const Endpoint& endpoint,
                          const LiveOptions& live) {
  if (!live.any()) return {};
  const auto frames = client.Frames(job);
  if (!frames) return frames.error();
  return AddViews(views, live, TitleOf(job, *frames),
                  [&] { return std::make_unique<FarmPictures>(endpoint, job); });
}

}  // namespace

Result<JobStatus> WatchWithViews(CoordinatorClient& client, JobId job, const ConnectionOptions& connection,
                                 const LiveOptions& live, Cancellation& cancellation) {
  const auto endpoint = ChooseFarm(connection.farm);
  if (!endpoint) return endpoint.error();
  LiveViews views(cancellation.token());
  if (auto added = AddFarmViews(views, client, job, *endpoint, live); !added) return added.error();
  auto status = WatchWithProgress(client, job);
  if (status) views.Finish();
  return status;
}

Result<std::optional<JobStatus>> WatchPicture(JobId job, const ConnectionOptions& connection,
                                              const LiveOptions& live, Cancellation& cancellation) {
  const auto endpoint = ChooseFarm(connection.farm);
  if (!endpoint) return endpoint.error();
  // Ends this watch alone.
  Cancellation watch;
  const std::stop_callback on_stop(cancellation.token(), [&] { watch.Cancel(cancellation.error()); });
  const auto client = Connect(connection, watch);
  if (!client) return client.error();
  if (const auto known = (*client)->Status(job); !known) return known.error();
  std::atomic<bool> has_quit = false;
  TerminalScreen screen(watch.token(), [&] {
    has_quit = true;
    watch.Cancel({ErrorKind::kInterrupted, "q was pressed"});
  });
  LiveViews views(watch.token());
  if (auto added = AddFarmViews(views, **client, job, *endpoint, live); !added) return added.error();
  auto shown =
      views.Add(std::make_unique<FarmPictures>(*endpoint, job), std::make_unique<TerminalPicture>(screen));
  if (!shown) return shown.error();
  auto status = (*client)->Watch(job, [&](const JobStatus& now) {
    screen.ShowProgress([=, progress = ProgressOf(now)](size_t columns) {
      const std::string which = fmt::format("job {}  ", Number(job));
      return which + ProgressText(progress, "worker", columns - std::min(columns, which.size()));
    });
  });
  if (status) views.Finish();
  screen.Close();
  if (has_quit) return std::optional<JobStatus>();
  if (!status) return status.error();
  return std::optional(std::move(*status));
}

Result<std::vector<JobStatus>> WatchAll(const ConnectionOptions& options, Cancellation& cancellation,
                                        const std::vector<JobId>& jobs,
                                        const std::function<void(const JobStatus&)>& on_end) {
  ProgressBoard board;
  std::mutex mutex;
  std::optional<Error> error;  // the first
  std::vector<JobStatus> last(jobs.size());
  const auto fail = [&](Error why) {
    {
      const std::lock_guard lock(mutex);
      if (!error) error = why;
    }
    cancellation.Cancel(std::move(why));  // the others end, too
  };
  const auto watch = [&](size_t i) {
    const auto client = Connect(options, cancellation);
    if (!client) return fail(client.error());
    auto status = (*client)->Watch(
        jobs[i], [&](const JobStatus& now) { board.Show(now.job, JobText(now), HasEnded(now.state)); });
    if (!status) return fail(status.error());
    const std::lock_guard lock(mutex);
    if (on_end) on_end(*status);
    last[i] = std::move(*status);
  };
  ThreadGroup threads(fail);
  for (size_t i = 0; i < jobs.size(); ++i) {
    if (const auto started = threads.Start([&watch, i] { watch(i); }); !started) {
      fail(started.error());
      break;
    }
  }
  threads.Join();
  if (error) return *error;
  return last;
}

Error EndedWithoutPicture(const JobStatus& status) {
  const std::string finished =
      status.frames_total > 1 && status.frames_finished > 0
          ? fmt::format(" ({} of {} frames are finished)", status.frames_finished, status.frames_total)
          : "";
  return Failed(fmt::format("job {} {}{}{}{}", Number(status.job),
                            status.state == JobState::kFailed ? "failed" : "was cancelled", finished,
                            status.reason.empty() ? "" : ": ", status.reason));
}

}  // namespace tessera
