// tessera logs
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/default_job.h"
#include "client/commands/option_groups.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kFollowInterval{1};

struct LogsOptions {
  std::optional<JobId> job;  // nullopt: the default job
  ConnectionOptions connection;
  bool follow = false;
  bool json = false;
};

void AddLogsFlags(CLI::App& app, LogsOptions& options) {
  AddDefaultJobArgument(app, options.job);
  AddSwitch(app, "--follow", "Also print what is added until the job has ended", options.follow);
  AddConnectionFlags(app, options.connection);
  AddJsonFlag(app, options.json);
}

std::string EntryJson(const JobLogEntry& entry) {
  const nlohmann::ordered_json json{{"number", entry.number},
                                    {"unix_time", static_cast<double>(entry.unix_time_ms) / 1000},
                                    {"level", MessageLevelName(entry.level)},
                                    {"text", entry.text}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string EntryText(const JobLogEntry& entry) {
  const std::tm time = fmt::gmtime(static_cast<std::time_t>(entry.unix_time_ms / 1000));
  return fmt::format("{:%Y-%m-%d %H:%M:%S}Z  {:<7}  {}", time, MessageLevelName(entry.level), entry.text);
}

// Waits until the next call is due. Returns false if a stop is requested meanwhile.
bool AwaitNextCall(const Cancellation& cancellation) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, cancellation.token(), kFollowInterval, [] { return false; });
  return !cancellation.cancelled();
}

Result<int> RunLogs(const LogsOptions& options, Cancellation& cancellation) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto job = ChooseJob(**client, options.connection, options.job);
  if (!job) return job.error();
  uint64_t after = 0;
  while (true) {
    const auto page = (*client)->JobLog(*job, after);
    if (!page) return page.error();
    for (const JobLogEntry& entry : page->entries) {
      fmt::print("{}\n", options.json ? EntryJson(entry) : EntryText(entry));
      after = entry.number;
    }
    std::fflush(stdout);  // for readers of a pipe
    if (page->has_more && !page->entries.empty()) continue;
    if (!options.follow || page->has_ended) return 0;
    if (!AwaitNextCall(cancellation)) return cancellation.error();
  }
}

}  // namespace

Command LogsCommand() {
  return MakeCommand<LogsOptions>({
      .name = "logs",
      .summary = "Print the log of a job: changes of its state, failures and warnings",
      .examples = {{"Print the log of your job", "tessera logs"},
                   {"Print the log of job 12", "tessera logs 12"},
                   {"Follow it until the job has ended", "tessera logs 12 --follow"}},
      .add_flags = AddLogsFlags,
      .run = RunLogs,
  });
}

}  // namespace tessera
