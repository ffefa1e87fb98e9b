#include "coordinator/coordinator.h"

#include <signal.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "coordinator/blob_service.h"
#include "coordinator/core_thread.h"
#include "coordinator/jobs_service.h"
#include "coordinator/picture_writer.h"
#include "coordinator/server.h"
#include "coordinator/work_service.h"
#include "store/data_dir.h"
#include "store/file_journal.h"

namespace tessera {
namespace {

struct Recovered {
  std::unique_ptr<Farm> farm;
  std::unique_ptr<Journal> journal;
};

// The farm as its journal tells.
Result<Recovered> Recover(const DataDir& directory, int attempts_max) {
  std::vector<Fact> facts;
  uint32_t epoch = 1;
  auto journal = FileJournal::Open(directory.JournalPath(), [&](const Fact& fact) {
    if (const auto* started = std::get_if<CoordinatorStarted>(&fact)) epoch = started->epoch + 1;
    facts.push_back(fact);
  });
  if (!journal) return journal.error();
  Recovered recovered{std::make_unique<Farm>(SchedulerOptions{epoch, attempts_max}), std::move(*journal)};
  for (const Fact& fact : facts) recovered.farm->Restore(fact);
  return recovered;
}

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
  auto recovered = Recover(*directory, options.attempts_max);
  if (!recovered) return recovered.error();

  PictureWriter writer(*directory);
  CoreThread* core_of_writer = nullptr;
  CoreThread core(std::move(recovered->farm), std::move(recovered->journal),
                  [&](FinishedPicture picture) { writer.Write(*core_of_writer, std::move(picture)); });
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
  return {};
}

}  // namespace tessera
