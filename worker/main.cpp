// `tessera-worker`: renders for a farm until it is told to end.
#include <fmt/format.h>
#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <exception>
#include <optional>

#include "renderer/util/ending_signals.h"
#include "renderer/util/processor.h"
#include "worker/options.h"
#include "worker/worker.h"

namespace tessera {
namespace {

int Report(const Error& error) {
  fmt::print(stderr, "tessera-worker: {}\n", error.message);
  return static_cast<int>(error.kind);
}

// The first signal drains; the second ends us at once.
void OnSignal(std::stop_source& stop, int count) {
  if (count > 1) ::_exit(static_cast<int>(ErrorKind::kInterrupted));
  stop.request_stop();
}

void SetUpLog(const std::string& level) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt("worker"));
  spdlog::set_level(spdlog::level::from_str(level));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %l %v");
}

int Run(const std::vector<std::string>& arguments, std::stop_token stop) {
  const auto parsed = ParseWorkerCommandLine(arguments);
  if (!parsed) return Report(parsed.error());
  if (!parsed->answer.empty()) {
    fmt::print("{}", parsed->answer);
    return 0;
  }
  const WorkerOptions& options = parsed->options;
  if (auto prepared = BlobCache::Prepare(options.cache_dir); !prepared) return Report(prepared.error());
  SetUpLog(options.log_level);
  Worker worker(options);
  const auto ended = worker.Run(stop);
  const int code = ended ? 0 : Report(ended.error());
  spdlog::default_logger()->flush();
  if (worker.IsLoading()) ::_exit(code);  // a large scene is being built, which cannot be hurried
  return code;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::RequireProcessor();
  ::signal(SIGPIPE, SIG_IGN);  // a reader of our log that goes away is not our end
  std::stop_source stop;
  const tessera::EndingSignals signals([&stop](int count) { tessera::OnSignal(stop, count); });
  try {
    return tessera::Run({argv + 1, argv + argc}, stop.get_token());
  } catch (const std::exception& e) {  // out of memory and the like
    return tessera::Report(tessera::Failed(e.what()));
  }
}
