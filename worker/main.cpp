// `tessera-worker`: renders for a farm until it is told to stop.
#include <fmt/format.h>
#include <unistd.h>

#include "proto/blobs/blob_store.h"
#include "proto/shell/log.h"
#include "proto/shell/program.h"
#include "proto/wire/tls_credentials.h"
#include "renderer/formats/loader/module_loader.h"
#include "worker/cache_folder.h"
#include "worker/farm_login.h"
#include "worker/options.h"
#include "worker/worker.h"

namespace tessera {
namespace {

constexpr const char* kProgram = "tessera-worker";

Result<int> Run(const std::vector<std::string>& arguments, std::stop_token termination) {
  const auto parsed = ParseWorkerCommandLine(arguments, termination);
  if (!parsed) return parsed.error();
  if (!parsed->answer.empty()) {
    fmt::print("{}", parsed->answer);
    return 0;
  }
  const WorkerOptions& options = parsed->options;
  StartLog(options.log_level);
  const auto coordinator = ReachFarm(options);
  if (!coordinator) return coordinator.error();
  // A worker without it would fail the jobs whose pictures need it.
  if (const auto installed = image_module::CheckInstalled(); !installed) return installed.error();
  auto folder = OpenCacheFolder(options.cache_dir);
  if (!folder) return BadInput("--cache-dir: " + folder.error().message);
  auto cache = BlobStore::Open(std::move(*folder), BlobStoreOptions::Cache(options.cache_bytes));
  if (!cache) return BadInput("--cache-dir: " + cache.error().message);
  const auto worker = Worker::Make(options, *coordinator, std::move(*cache));
  if (!worker) return worker.error();
  const auto ended = (*worker)->Run(termination);
  const int code = ended ? 0 : Report(kProgram, ended.error());
  // Building a large scene cannot be interrupted, so the destructor of Worker might take long.
  if ((*worker)->IsLoading()) ::_exit(code);
  return code;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::PrepareTls();  // before there are threads
  return tessera::RunProgram(tessera::kProgram, argc, argv, tessera::Run);
}
