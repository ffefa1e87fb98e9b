// `tessera-worker`: renders for a farm until it is told to stop.
#include <fmt/format.h>
#include <unistd.h>

#include "proto/shell/log.h"
#include "proto/shell/program.h"
#include "worker/options.h"
#include "worker/worker.h"

namespace tessera {
namespace {

constexpr const char* kProgram = "tessera-worker";

Result<int> Run(const std::vector<std::string>& arguments, std::stop_token termination) {
  const auto parsed = ParseWorkerCommandLine(arguments);
  if (!parsed) return parsed.error();
  if (!parsed->answer.empty()) {
    fmt::print("{}", parsed->answer);
    return 0;
  }
  const WorkerOptions& options = parsed->options;
  if (auto prepared = BlobCache::Prepare(options.cache_dir); !prepared) return prepared.error();
  StartLog(options.log_level);
  Worker worker(options);
  const auto ended = worker.Run(termination);
  const int code = ended ? 0 : Report(kProgram, ended.error());
  // Building a large scene cannot be interrupted, so the destructor of Worker might take long.
  if (worker.IsLoading()) ::_exit(code);
  return code;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  return tessera::RunProgram(tessera::kProgram, argc, argv, tessera::Run);
}
