// Gets blobs from the cache, or else from the coordinator.
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "util/digest.h"
#include "util/result.h"
#include "worker/blob_cache.h"

namespace grpc {
class Channel;
}

namespace tessera {

// Thread safe.
class BlobFetcher {
 public:
  // A request to stop ends every download. `seed` is of the waits between attempts.
  BlobFetcher(std::shared_ptr<grpc::Channel> channel, BlobCache& cache, std::stop_token stop, uint64_t seed)
      : channel_(std::move(channel)), cache_(cache), stop_(std::move(stop)), seed_(seed) {}
  // The bytes of the blob. A download that breaks goes on where it stopped, for as long as something comes
  // in.
  Result<std::string> Get(const Digest& digest, uint64_t size_max);

 private:
  Result<std::string> Download(const Digest& digest, uint64_t size_max);

  std::shared_ptr<grpc::Channel> channel_;
  BlobCache& cache_;
  std::stop_token stop_;
  uint64_t seed_;
};

}  // namespace tessera
