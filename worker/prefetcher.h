// Fetches the files of scenes that this worker will need soon, while it renders something else.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <vector>

#include "renderer/util/digest.h"
#include "worker/blob_fetcher.h"

namespace tessera {

// Wish is thread safe; Run belongs to the thread that runs it.
class Prefetcher {
 public:
  explicit Prefetcher(BlobFetcher& fetcher) : fetcher_(fetcher) {}
  // The packages to have, the most wanted first; those wished for before and not begun are forgotten.
  void Wish(std::vector<Digest> packages);
  // Until a stop is requested. A package that cannot be had is no failure: whoever needs it tries again.
  void Run(std::stop_token stop);

 private:
  BlobFetcher& fetcher_;
  std::mutex mutex_;
  std::condition_variable_any wished_;
  std::vector<Digest> packages_;  // guarded by mutex_
};

}  // namespace tessera
