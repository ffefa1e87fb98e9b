#include "worker/prefetcher.h"

#include <spdlog/spdlog.h>

#include <exception>

#include "renderer/text/unicode.h"

namespace tessera {

void Prefetcher::Request(std::vector<Digest> packages) {
  {
    const std::lock_guard lock(mutex_);
    packages_ = std::move(packages);
  }
  requested_.notify_all();
}

void Prefetcher::Run(std::stop_token stop) {
  while (true) {
    Digest package;
    {
      std::unique_lock lock(mutex_);
      if (!requested_.wait(lock, stop, [this] { return !packages_.empty(); })) return;
      package = packages_.front();
      packages_.erase(packages_.begin());
    }
    try {
      const auto fetched = fetcher_.FetchPackage(package);
      if (stop.stop_requested()) return;
      if (fetched) {
        spdlog::info("prefetched package={} bytes={}", package.Hex(), *fetched);
      } else {
        spdlog::warn("prefetch_failed package={} reason={}", package.Hex(), LogText(fetched.error().message));
      }
    } catch (const std::exception& e) {  // such as std::bad_alloc
      spdlog::warn("prefetch_failed package={} reason={}", package.Hex(), LogText(e.what()));
    }
  }
}

}  // namespace tessera
