// A worker: threads around a shared workload.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>

#include "proto/blobs/blob_store.h"
#include "proto/wire/endpoint.h"
#include "renderer/util/result.h"
#include "renderer/util/shared_cache.h"
#include "renderer/util/threads.h"
#include "worker/activity_meter.h"
#include "worker/blob_fetcher.h"
#include "worker/options.h"
#include "worker/prefetcher.h"
#include "worker/result_sender.h"
#include "worker/shared_workload.h"
#include "worker/synchronizer.h"

namespace tessera {

// `threads` threads render; one loads scenes, one prefetches files, one exchanges states and one sends
// results.
class Worker {
 public:
  // `cache` holds scene files. An error if this machine cannot render or cannot start the threads.
  static Result<std::unique_ptr<Worker>> Make(const WorkerOptions& options, const Endpoint& coordinator,
                                              BlobStore cache);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Works until a stop is requested, then drains within some seconds and leaves the farm. An error if the
  // coordinator does not admit this worker.
  Result<void> Run(std::stop_token stop);
  // Whether a scene is still being loaded after Run. The destructor waits for it.
  bool IsLoading();

 private:
  Worker(const WorkerOptions& options, const Endpoint& coordinator, WorkerState self, BlobStore cache);
  Result<void> StartThreads();
  void Render();
  void LoadScenes();
  void LoadScene(const SceneRequest& order);
  void Prepare(const PreparationRequest& request);
  void FetchFiles(const SceneRequest& order);
  void OnRefusal(Error why);
  void Drain();

  std::stop_source closing_;          // ends all threads
  const std::optional<Login> login_;  // whose certificate is renewed
  std::shared_ptr<grpc::Channel> states_channel_, bulk_channel_;
  WorkerState self_;
  int threads_;
  const LoadLimits load_limits_;
  ActivityMeter meter_;
  BlobStore cache_;
  BlobFetcher fetcher_;
  std::shared_ptr<SharedCache> assets_;  // shared by scenes, which hold parts of it
  Prefetcher prefetcher_;
  SharedWorkload workload_;
  Synchronizer synchronizer_;
  ResultSender sender_;
  std::mutex mutex_;  // of the members up to the next blank line
  std::condition_variable loader_ended_;
  std::optional<Error> refusal_;
  bool loader_is_done_ = false;

  std::stop_source refused_;
  ThreadGroup pool_, loader_;
};

}  // namespace tessera
