#include "coordinator/coordinator.h"

#include <spdlog/spdlog.h>

#include <condition_variable>
#include <cstdio>
#include <mutex>

#include "coordinator/ask_core.h"
#include "coordinator/blob_service.h"
#include "coordinator/core_thread.h"
#include "coordinator/jobs_service.h"
#include "coordinator/picture_writer.h"
#include "coordinator/recovery.h"
#include "coordinator/server.h"
#include "coordinator/store/data_dir.h"
#include "coordinator/web_server.h"
#include "coordinator/work_service.h"

namespace tessera {
namespace {

void AwaitStop(std::stop_token stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait(lock, stop, [] { return false; });
  spdlog::info("stopping");
}

// Nothing if no web page was asked for.
Result<std::unique_ptr<WebServer>> StartWeb(const CoordinatorOptions& options, CoreThread& core,
                                            const WorkService& work, const BlobService& blobs,
                                            const BlobStore& store) {
  if (!options.http) return std::unique_ptr<WebServer>();
  auto web = WebServer::Start(*options.http, [&]() -> std::optional<FarmView> {
    auto view = LookAtFarm(core);
    if (!view) return view;
    view->traffic = {work.bytes_in(), blobs.bytes_in(), blobs.bytes_out()};
    view->intake = {work.intake().bytes(), work.intake().waiting()};
    view->blob_bytes = store.bytes();
    return view;
  });
  if (web) std::fprintf(stderr, "status page at http://%s/\n", (*web)->address().Text().c_str());
  return web;
}

}  // namespace

Result<void> RunCoordinator(const CoordinatorOptions& options, std::stop_token termination) {
  auto directory = DataDir::Open(options.data_dir);
  if (!directory) return directory.error();
  auto blobs = BlobStore::Open(directory->BlobsPath(), options.blob_bytes);
  if (!blobs) return blobs.error();
  BackgroundThread spooling;
  const auto run = [&](std::function<void()> task) { spooling.Post(std::move(task)); };
  auto parts = Recover(*directory, {options.attempts_max, options.keep_sums_bytes}, run);
  if (!parts) return parts.error();

  PictureWriter writer(*directory);
  CoreThread* core_of_writer = nullptr;
  parts->write_picture = [&](FinishedPicture picture) { writer.Write(*core_of_writer, std::move(picture)); };
  parts->remove_pictures = [&](JobId job) { spooling.Post([&, job] { directory->RemovePictures(job); }); };
  CoreThread core(std::move(*parts));
  core_of_writer = &core;
  blobs->Protect(
      [&core] { return AskCore(core, [](CoreContext& context) { return context.farm.PackagesInUse(); }); });
  WorkService work(core);
  BlobService blob_service(*blobs);
  JobsService jobs(core, *blobs, *directory);
  auto web = StartWeb(options, core, work, blob_service, *blobs);
  if (!web) return web.error();
  auto server = CoordinatorServer::Start(options.listen, work, blob_service, jobs);
  if (!server) return server.error();
  for (const Address& address : (*server)->addresses()) {
    std::fprintf(stderr, "listening on %s\n", address.Text().c_str());
  }
  AwaitStop(std::move(termination));
  web->reset();
  // Waiting calls first, then no new ones, then what their answers need.
  core.Close();
  (*server)->Shutdown();
  jobs.Stop();
  writer.Stop();
  core.Stop();
  spooling.Stop();
  return {};
}

}  // namespace tessera
