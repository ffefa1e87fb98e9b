// Gets blobs from the cache or, if they are not there, from the coordinator.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "proto/blobs/blob_store.h"
#include "proto/scene_package.h"
#include "proto/shell/rare_log.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace grpc {
class Channel;
}

namespace tessera {

// How long downloads may take.
struct FetchPatience {
  // Without a chunk for this long an attempt has stalled.
  std::chrono::milliseconds stall{60'000};
  // Without progress for this long, over all attempts, a download fails its scene; the coordinator decides
  // what happens then. Until then refusals and outages are the coordinator's and not the scene's.
  std::chrono::milliseconds download{std::chrono::minutes(30)};
};

// Thread safe.
class BlobFetcher {
 public:
  // A request to stop ends every download. `seed` sets the waits between attempts. `on_bytes` is called with
  // the number of bytes of each piece received, from any thread.
  BlobFetcher(std::shared_ptr<grpc::Channel> channel, const BlobStore& cache, std::stop_token stop,
              uint64_t seed, std::function<void(uint64_t)> on_bytes, FetchPatience patience = {})
      : channel_(std::move(channel)),
        cache_(cache),
        stop_(std::move(stop)),
        seed_(seed),
        on_bytes_(std::move(on_bytes)),
        patience_(patience) {}
  // The bytes of a blob of a scene package: a file or the manifest. A download that breaks is resumed where
  // it stopped, as long as it makes progress.
  Result<std::string> Get(const Digest& package, const Digest& digest, uint64_t size_max);
  // Fetches all files of the package into the cache, several in parallel, each once per machine. Returns the
  // number of bytes received. Files that do not fit into the cache are left to Get.
  Result<uint64_t> FetchPackage(const Digest& package);

 private:
  // Receives the bytes of a blob: how many have arrived, and how to add some.
  struct Sink {
    std::function<uint64_t()> size;
    std::function<Result<void>(std::string_view)> add;
  };
  struct Wanted {
    Digest package, digest;
    uint64_t size_max = 0;
    bool suspect = false;  // other bytes than those of the digest were received before
  };
  Result<void> Download(const Wanted& wanted, const Sink& sink);
  std::optional<std::string> ReadCached(const Digest& digest, uint64_t size_max);
  Result<std::string> DownloadToMemory(const Wanted& wanted);
  Result<uint64_t> FetchFile(const Digest& package, const PackageFile& file);

  std::shared_ptr<grpc::Channel> channel_;
  const BlobStore& cache_;
  std::stop_token stop_;
  uint64_t seed_;
  const std::function<void(uint64_t)> on_bytes_;
  const FetchPatience patience_;
  RareLog waits_{std::chrono::minutes(1)};  // for the coordinator's transfers
};

}  // namespace tessera
