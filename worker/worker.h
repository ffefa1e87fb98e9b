// A worker: threads around a workbench.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "renderer/util/result.h"
#include "renderer/util/shared_cache.h"
#include "worker/activity_meter.h"
#include "worker/blob_cache.h"
#include "worker/blob_fetcher.h"
#include "worker/options.h"
#include "worker/prefetcher.h"
#include "worker/returner.h"
#include "worker/synchronizer.h"
#include "worker/workbench.h"

namespace tessera {

// `threads` threads render, one loads scenes, one fetches files ahead, one exchanges
// states, one returns results.
class Worker {
 public:
  explicit Worker(const WorkerOptions& options);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Works until a stop is requested; then drains, within some seconds, and says goodbye. An error if the
  // coordinator does not admit this worker.
  Result<void> Run(std::stop_token stop);
  // Whether, after Run, a scene is still being loaded: the destructor waits for it.
  bool IsLoading();

 private:
  void Render();
  void LoadScenes();
  void FetchFiles(const SceneOrder& order);
  void OnRefusal(Error why);
  void Drain();

  std::stop_source closing_;  // ends all threads
  std::shared_ptr<grpc::Channel> states_channel_, bulk_channel_;
  WorkerState self_;
  int threads_;
  ActivityMeter meter_;
  BlobCache cache_;
  BlobFetcher fetcher_;
  std::shared_ptr<SharedCache> assets_;  // what scenes share; scenes hold parts of it
  Prefetcher prefetcher_;
  Workbench bench_;
  Synchronizer synchronizer_;
  Returner returner_;
  std::mutex mutex_;  // of the members up to the blank line
  std::condition_variable loader_ended_;
  std::optional<Error> refusal_;
  bool loader_is_done_ = false;

  std::stop_source refused_;
  std::vector<std::thread> crew_;
  std::thread loader_;
};

}  // namespace tessera
