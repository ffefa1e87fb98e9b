// tessera submit
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/live_options.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/commands/print_forecast.h"
#include "client/commands/watching.h"
#include "client/notify_command.h"
#include "client/progress_line.h"
#include "client/scene_job.h"
#include "proto/shell/console.h"
#include "renderer/util/cores.h"

namespace tessera {
namespace {

struct SubmitOptions {
  SceneOptions scene;
  ConnectionOptions connection;
  std::string name;  // of the job; empty: named after the scene
  int priority = 0;
  std::set<std::string> required_tags;
  double verify_share = 0;
  std::optional<Region> first;
  bool watch = false;
  LiveOptions live;
  std::string notify_command;
  bool dry_run = false;
  bool json = false;
};

void AddSubmitFlags(CLI::App& app, SubmitOptions& options) {
  AddSceneFlags(app, options.scene);
  AddSceneMemoryFlag(app, options.scene);
  AddConnectionFlags(app, options.connection);
  AddText(app, "--name", "NAME", WithDefault("Name of the job", "SCENE without its extension"), options.name);
  AddValue(app, "--priority", "N", WithDefault("Jobs with a higher priority run first", "0"),
           options.priority, WholeNumber<int>(-kPriorityMax, kPriorityMax));
  AddRepeatedWord(app, "--require", "TAG", "Lease the job only to workers with this tag; may be repeated",
                  static_cast<int>(kTagsMax), [&options](const std::string& word) -> Result<void> {
                    const auto tag = ParseTag("--require", word);
                    if (!tag) return tag.error();
                    options.required_tags.insert(*tag);
                    return {};
                  });
  AddFirstFlag(app, options.first);
  AddVerifyFlag(app, options.verify_share);
  AddSwitch(app, "--watch", "Follow the job's progress until it ends", options.watch);
  AddLiveFlags(app, options.live);
  AddNotifyFlag(app, options.notify_command);
  AddDryRunFlag(app, options.dry_run);
  AddJsonFlag(app, options.json);
}

Result<void> CheckSubmit(const SubmitOptions& options) {
  if (options.watch) return {};
  const char* const flag = !options.notify_command.empty() ? "--notify-command"
                           : !options.live.preview.empty() ? "--preview"
                           : options.live.display          ? "--display"
                                                           : nullptr;
  if (flag == nullptr) return {};
  return BadInput(fmt::format("{} needs --watch: submit ends before the job does", flag));
}

constexpr std::chrono::seconds kDryRunPatience{3};  // the farm is worth one line

// What the farm has for the job. Prints why if it is not reached, as an estimate does not depend on it.
Result<std::optional<FarmCapacity>> AskCapacity(const SubmitOptions& options, Cancellation& cancellation) {
  ConnectionOptions connection = options.connection;
  connection.patience.connection =
      std::min<std::chrono::milliseconds>(connection.patience.connection, kDryRunPatience);
  const auto ask = [&]() -> Result<FarmCapacity> {
    const auto endpoint = ChooseFarm(connection.farm);
    if (!endpoint) return endpoint.error();
    const auto client = CoordinatorClient::Connect(*endpoint, connection.patience, cancellation.token());
    if (!client) return client.error();
    uint64_t left_out = 0;
    const auto workers = (*client)->Workers(left_out);
    if (!workers) return workers.error();
    const auto jobs = (*client)->Jobs(left_out);
    if (!jobs) return jobs.error();
    return CapacityFor(endpoint->address.Text(), options.required_tags, options.priority, *workers, *jobs);
  };
  auto capacity = ask();
  if (cancellation.cancelled()) return cancellation.error();
  if (capacity) return std::optional(std::move(*capacity));
  PrintNote("tessera: there is no estimate for the farm: {}\n", capacity.error().message);
  return std::optional<FarmCapacity>();
}

Result<int> RunDryRun(const SubmitOptions& options, Cancellation& cancellation) {
  const auto farm = AskCapacity(options, cancellation);
  if (!farm) return farm.error();
  return PrintForecast(options.scene, UsableCores(), options.json, cancellation, *farm);
}

Result<int> RunSubmit(const SubmitOptions& options, Cancellation& cancellation) {
  if (options.dry_run) return RunDryRun(options, cancellation);
  const auto job = LoadSceneJob(options.scene, Scene::Depth::kCheck, cancellation.token());
  if (!job) return job.error();
  if (auto good = CheckFirst(options.first, job->packed.frames); !good) return good.error();
  if (auto good = CheckLive(options.live, job->input_paths); !good) return good.error();
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto sent =
      (*client)->Upload(job->packed, [](const std::string& reason) { PrintNote("tessera: {}\n", reason); });
  if (!sent) return sent.error();
  PrintNote("uploaded {} of {} files, {}\n", sent->files_sent, sent->files_total,
            BytesText(sent->bytes_sent));
  const std::string name = options.name.empty() ? SceneName(options.scene) : options.name;
  const auto id = (*client)->Submit(
      job->packed, {name, options.priority, options.required_tags, options.verify_share, options.first});
  if (!id) return id.error();
  if (options.json) {
    fmt::print("{{\"job\":{}}}\n", Number(*id));
  } else {
    fmt::print("{}\n", Number(*id));
  }
  std::fflush(stdout);  // a script may read it while this command watches the job
  if (!options.watch) return 0;
  const auto status = WatchWithViews(**client, *id, options.connection, options.live, cancellation);
  if (!status) return status.error();
  RunNotifyCommand(options.notify_command, NoticeOf(*status));
  if (status->state != JobState::kFinished) return EndedWithoutPicture(*status);
  return 0;
}

}  // namespace

Command SubmitCommand() {
  return MakeCommand<SubmitOptions>({
      .name = "submit",
      .summary = "Submit a scene to a farm and print the job id",
      .examples = {{"Submit a scene and print the job id",
                    "tessera submit scene.pbrt --coordinator farm.example:7700"},
                   {"Submit an urgent job and follow it", "tessera submit scene.pbrt --priority 10 --watch"},
                   {"Render the upper left quarter of the picture first",
                    "tessera submit scene.pbrt --first 0,0.5,0,0.5"}},
      .add_flags = AddSubmitFlags,
      .check = CheckSubmit,
      .run = RunSubmit,
  });
}

}  // namespace tessera
