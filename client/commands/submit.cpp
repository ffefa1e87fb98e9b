// tessera submit
#include <fmt/format.h>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
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
  bool watch = false;
  std::string notify_command;
  bool dry_run = false;
  bool json = false;
};

void AddSubmitFlags(CLI::App& app, SubmitOptions& options) {
  AddSceneFlags(app, options.scene);
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
  AddVerifyFlag(app, options.verify_share);
  AddSwitch(app, "--watch", "Follow the job's progress until it ends", options.watch);
  AddNotifyFlag(app, options.notify_command);
  AddDryRunFlag(app, options.dry_run);
  AddJsonFlag(app, options.json);
}

Result<void> CheckSubmit(const SubmitOptions& options) {
  if (options.notify_command.empty() || options.watch) return {};
  return BadInput("--notify-command needs --watch: submit ends before the job does");
}

Result<int> RunSubmit(const SubmitOptions& options, Cancellation& cancellation) {
  if (options.dry_run) return PrintForecast(options.scene, UsableCores(), options.json, cancellation);
  const auto job = LoadSceneJob(options.scene, Scene::Depth::kCheck, cancellation.token());
  if (!job) return job.error();
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto sent =
      (*client)->Upload(job->packed, [](const std::string& reason) { PrintNote("tessera: {}\n", reason); });
  if (!sent) return sent.error();
  PrintNote("uploaded {} of {} files, {}\n", sent->files_sent, sent->files_total,
            BytesText(sent->bytes_sent));
  const std::string name = options.name.empty() ? SceneName(options.scene) : options.name;
  const auto id =
      (*client)->Submit(job->packed, {name, options.priority, options.required_tags, options.verify_share});
  if (!id) return id.error();
  if (options.json) {
    fmt::print("{{\"job\":{}}}\n", Number(*id));
  } else {
    fmt::print("{}\n", Number(*id));
  }
  std::fflush(stdout);  // a script may read it while this command watches the job
  if (!options.watch) return 0;
  const auto status = WatchWithProgress(**client, *id);
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
                   {"Submit an urgent job and follow it", "tessera submit scene.pbrt --priority 10 --watch"}},
      .add_flags = AddSubmitFlags,
      .check = CheckSubmit,
      .run = RunSubmit,
  });
}

}  // namespace tessera
