// tessera submit: hands a scene to a farm.
#include <fmt/format.h>

#include <filesystem>

#include "client/commands.h"
#include "client/progress_line.h"
#include "client/reach_coordinator.h"
#include "client/scene_job.h"
#include "client/watching.h"

namespace tessera {

Result<int> RunSubmit(const Options& options, Cancellation& cancellation) {
  const auto job = LoadSceneJob(options, Scene::Depth::kCheck, cancellation.token());
  if (!job) return job.error();
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto sent = (*client)->Upload(job->packed);
  if (!sent) return sent.error();
  fmt::print(stderr, "uploaded {} of {} files, {}\n", sent->files_sent, sent->files_total,
             BytesText(sent->bytes_sent));
  const std::string name =
      options.name.empty() ? std::filesystem::path(options.scene).stem().string() : options.name;
  const auto id =
      (*client)->Submit(job->packed, {name, options.priority, options.required_tags, options.verify_share});
  if (!id) return id.error();
  if (options.json) {
    fmt::print("{{\"job\":{}}}\n", Number(*id));
  } else {
    fmt::print("{}\n", Number(*id));
  }
  std::fflush(stdout);  // scripts read it while we watch
  if (!options.watch) return 0;
  const auto status = WatchWithProgress(**client, *id);
  if (!status) return status.error();
  if (status->state != JobState::kFinished) return EndedWithoutPicture(*status);
  return 0;
}

}  // namespace tessera
