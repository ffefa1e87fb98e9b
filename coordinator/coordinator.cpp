#include "coordinator/coordinator.h"

#include <signal.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "coordinator/blob_service.h"
#include "coordinator/core_thread.h"
#include "coordinator/jobs_service.h"
#include "coordinator/picture_writer.h"
#include "coordinator/recovery.h"
#include "coordinator/server.h"
#include "coordinator/work_service.h"
#include "store/data_dir.h"

namespace tessera {
namespace {

void WaitForSignal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  int signal = 0;
  sigwait(&signals, &signal);
  spdlog::info("signal number={}", signal);
}

}  // namespace

Result<void> RunCoordinator(const CoordinatorOptions& options) {
  auto directory = DataDir::Open(options.data_dir);
  if (!directory) return directory.error();
  auto blobs = BlobStore::Open(directory->BlobsPath());
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
  WorkService work(core);
  BlobService blob_service(*blobs);
  JobsService jobs(core, *blobs, *directory);
  auto server = CoordinatorServer::Start(options.listen, work, blob_service, jobs);
  if (!server) return server.error();
  for (const Address& address : (*server)->addresses()) {
    std::fprintf(stderr, "listening on %s\n", address.Text().c_str());
  }
  WaitForSignal();
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
