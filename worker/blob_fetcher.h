// Gets blobs from the cache, or else from the coordinator.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "proto/scene_package.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"
#include "worker/blob_cache.h"

namespace grpc {
class Channel;
}

namespace tessera {

// Thread safe.
class BlobFetcher {
 public:
  // A request to stop ends every download. `seed` is of the waits between attempts. `on_bytes` hears of all
  // bytes that come in, from any thread.
  BlobFetcher(std::shared_ptr<grpc::Channel> channel, BlobCache& cache, std::stop_token stop, uint64_t seed,
              std::function<void(uint64_t)> on_bytes)
      : channel_(std::move(channel)),
        cache_(cache),
        stop_(std::move(stop)),
        seed_(seed),
        on_bytes_(std::move(on_bytes)) {}
  // The bytes of the blob. A download that breaks goes on where it stopped, for as long as something comes
  // in.
  Result<std::string> Get(const Digest& digest, uint64_t size_max);
  // Gets all files of the package into the cache, several at the same time, each once on this machine whoever
  // needs it; how many bytes came in. Files that the cache has no room for are left to Get.
  Result<uint64_t> FetchPackage(const Digest& package);

 private:
  // Where the bytes of a blob go: how many there are, and how to add some.
  struct Sink {
    std::function<uint64_t()> size;
    std::function<Result<void>(std::string_view)> add;
  };
  Result<void> Download(const Digest& digest, uint64_t size_max, const Sink& sink);
  Result<std::string> DownloadToMemory(const Digest& digest, uint64_t size_max);
  Result<uint64_t> FetchFile(const PackageFile& file);

  std::shared_ptr<grpc::Channel> channel_;
  BlobCache& cache_;
  std::stop_token stop_;
  uint64_t seed_;
  const std::function<void(uint64_t)> on_bytes_;
};

}  // namespace tessera
