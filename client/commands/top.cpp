// tessera top
#include <fmt/format.h>
#include <unistd.h>

#include <string_view>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/commands/status_text.h"
#include "client/commands/top_text.h"
#include "client/screen.h"

namespace tessera {
namespace {

constexpr int kIntervalMax_s = 3600;

struct TopOptions {
  ConnectionOptions connection;
  int interval_s = 1;
  bool json = false;
};

void AddTopFlags(CLI::App& app, TopOptions& options) {
  AddInteger(app, "--interval", WithDefault("Seconds between updates", std::to_string(options.interval_s)), 1,
             kIntervalMax_s, options.interval_s);
  AddConnectionFlags(app, options.connection);
  AddJsonFlag(app, options.json);
}

Result<FarmView> Look(CoordinatorClient& client, const std::string& address) {
  FarmView view;
  view.address = address;
  auto jobs = client.Jobs(view.jobs_left_out);
  if (!jobs) return jobs.error();
  view.jobs = std::move(*jobs);
  auto workers = client.Workers(view.workers_left_out);
  if (!workers) return workers.error();
  view.workers = std::move(*workers);
  return view;
}

Result<int> RunTop(const TopOptions& options, Cancellation& cancellation) {
  const auto endpoint = ChooseFarm(options.connection.farm);
  if (!endpoint) return endpoint.error();
  const std::string address = endpoint->address.Text();
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  auto view = Look(**client, address);
  if (!view) return view.error();
  if (options.json) {
    fmt::print("{}\n", FarmJson(*view));
    return 0;
  }
  if (!Screen::IsAvailable()) {
    for (const std::string& line : TopLines(*view)) fmt::print("{}\n", line);
    return 0;
  }
  Screen screen;
  while (true) {
    screen.Show(TopScreen(*view, TerminalSizeOf(STDOUT_FILENO)));
    const auto key = screen.AwaitKey(std::chrono::seconds(options.interval_s), cancellation.token());
    if (cancellation.cancelled()) return cancellation.error();
    if (key && std::string_view("qQ\x1b").find(*key) != std::string_view::npos) return 0;
    view = Look(**client, address);
    if (!view) return view.error();
  }
}

}  // namespace

Command TopCommand() {
  return MakeCommand<TopOptions>({
      .name = "top",
      .summary = "Show jobs and workers on the whole terminal until q is pressed",
      .examples = {{"Look at the farm", "tessera top"},
                   {"Update every ten seconds, over a slow link", "tessera top --interval 10"},
                   {"Print jobs and workers once, for a script", "tessera top --json"}},
      .add_flags = AddTopFlags,
      .run = RunTop,
  });
}

}  // namespace tessera
