// A coordinator and workers on this machine, started for one job.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/cancellation.h"
#include "client/child_process.h"
#include "client/temporary_folder.h"
#include "renderer/util/threads.h"

namespace tessera {

struct LocalWorkers {
  int count = 1;                                        // processes
  int threads = 1;                                      // of each
  std::optional<uint64_t> scene_memory = std::nullopt;  // --scene-memory of each
};

// Its processes use a private folder and a Unix socket in it. They end with this object or with this process,
// however it ends. If the coordinator or the last worker ends by itself, the farm cancels with the reason.
class LocalFarm {
 public:
  // Starts the programs that are in the folder of this one. Call from the main thread (ChildProcess).
  // `cancellation` must outlive the farm. `kept`: the folder of a data directory that outlives the farm;
  // empty for none.
  static Result<std::unique_ptr<LocalFarm>> Start(const LocalWorkers& workers, Cancellation& cancellation,
                                                  const std::string& kept = "");
  ~LocalFarm();
  LocalFarm(const LocalFarm&) = delete;
  LocalFarm& operator=(const LocalFarm&) = delete;
  const std::string& address() const { return address_; }

 private:
  LocalFarm(TemporaryFolder folder, std::string socket, ChildProcess coordinator, Cancellation& cancellation);
  Result<void> AwaitCoordinator();
  Result<void> StartWorkers(const std::string& program, const LocalWorkers& workers);
  void Monitor();

  TemporaryFolder folder_;
  std::string socket_;
  std::string address_;
  ChildProcess coordinator_;
  std::vector<ChildProcess> workers_;
  Cancellation& cancellation_;
  int closing_fd_ = -1;  // an event that ends the monitor
  ThreadGroup monitor_;
};

}  // namespace tessera
