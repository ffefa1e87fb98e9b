// Fetches the files of scenes that this worker will need soon, while it renders something else.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <vector>

#include "renderer/util/digest.h"
#include "worker/blob_fetcher.h"

namespace tessera {

// Request is thread safe; Run belongs to the thread that calls it.
class Prefetcher {
 public:
  explicit Prefetcher(BlobFetcher& fetcher) : fetcher_(fetcher) {}
  // Sets the packages to fetch, the most urgent first. Replaces earlier requests that have not been started.
  void Request(std::vector<Digest> packages);
  // Fetches until a stop is requested. A package that cannot be fetched is no failure: it is fetched again
  // when a scene is loaded from it.
  void Run(std::stop_token stop);

 private:
  BlobFetcher& fetcher_;
  std::mutex mutex_;
  std::condition_variable_any requested_;
  std::vector<Digest> packages_;  // guarded by mutex_
};

}  // namespace tessera
