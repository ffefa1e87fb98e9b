#include "client/commands/worker_command.h"

#include <fmt/format.h>

#include "client/commands/connection.h"
#include "client/commands/option_groups.h"
#include "client/commands/status_text.h"
#include "proto/shell/console.h"

namespace tessera {
namespace {

struct WorkerOptions {
  std::string which;
  ConnectionOptions connection;
  bool json = false;
};

void AddFlags(CLI::App& app, WorkerOptions& options) {
  AddConnectionFlags(app, options.connection);
  AddJsonFlag(app, options.json);
}

void AddFlagsAndWorker(CLI::App& app, WorkerOptions& options) {
  AddText(app, "WORKER", "", "Name of one or more workers, or the id of one, as listed by workers",
          options.which, Presence::kRequired);
  AddFlags(app, options);
}

Result<int> Run(const WorkerOptions& options, Cancellation& cancellation, const WorkerCall& call) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  uint64_t left_out = 0;
  const auto workers = call(**client, options.which, left_out);
  if (!workers) return workers.error();
  if (left_out > 0) PrintNote("tessera: {} more workers are not listed\n", left_out);
  fmt::print("{}", options.json ? WorkersJson(*workers) + "\n" : WorkerTable(*workers));
  return 0;
}

Command Make(const std::string& name, const std::string& summary, Example example,
             void (*add_flags)(CLI::App&, WorkerOptions&), const WorkerCall& call) {
  return MakeCommand<WorkerOptions>({
      .name = name,
      .summary = summary,
      .examples = {std::move(example)},
      .add_flags = add_flags,
      .run = [call](const WorkerOptions& options,
                    Cancellation& cancellation) { return Run(options, cancellation, call); },
  });
}

}  // namespace

Command WorkerCommand(const std::string& name, const std::string& summary, const WorkerCall& call) {
  return Make(name, summary, {"For the workers named blade-7", fmt::format("tessera {} blade-7", name)},
              AddFlagsAndWorker, call);
}

Command AllWorkersCommand(const std::string& name, const std::string& summary, const WorkerCall& call) {
  return Make(name, summary, {"For all workers", "tessera " + name}, AddFlags, call);
}

}  // namespace tessera
