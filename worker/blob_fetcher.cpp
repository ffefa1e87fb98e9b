#include "worker/blob_fetcher.h"

#include <fmt/format.h>
#include <grpcpp/channel.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "proto/blobs.grpc.pb.h"
#include "proto/shell/backoff.h"
#include "proto/shell/pause.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/description/file_source.h"
#include "renderer/text/unicode.h"
#include "renderer/util/threads.h"
#include "worker/blob_stream.h"

namespace tessera {
namespace {

// Scenes have many small files: parallel downloads fill a network with long round trips.
constexpr size_t kParallelDownloads = 4;
// Between looks for a file that another thread or process is fetching.
constexpr std::chrono::milliseconds kPollInterval{50};

// Whether the same download may succeed later. gRPC ends calls with RESOURCE_EXHAUSTED while the coordinator
// is short of memory.
bool MayPass(const grpc::Status& status) {
  return IsTransient(status) || status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED ||
         status.error_code() == grpc::StatusCode::ABORTED;
}

}  // namespace

Result<std::string> BlobFetcher::Get(const Digest& package, const Digest& digest, uint64_t size_max) {
  if (auto cached = ReadCached(digest, size_max)) return std::move(*cached);
  Wanted wanted{package, digest, std::min(size_max, kSceneFileSizeMax)};
  auto bytes = DownloadToMemory(wanted);
  if (!bytes) return bytes;
  // The second time the coordinator reads its file again and drops it if it is corrupt.
  wanted.suspect = Sha256(*bytes) != digest;
  if (wanted.suspect) bytes = DownloadToMemory(wanted);
  if (!bytes) return bytes;
  if (Sha256(*bytes) != digest) {
    return Failed(
        fmt::format("the file {} received from the coordinator is corrupt (SHA-256 mismatch)", digest.Hex()));
  }
  if (bytes->size() > cache_.bytes_max()) return bytes;
  // A failure costs another download later.
  if (const auto cached = cache_.Write(digest, *bytes); !cached)
    spdlog::warn("cache_failed reason={}", LogText(cached.error().message));
  return bytes;
}

std::optional<std::string> BlobFetcher::ReadCached(const Digest& digest, uint64_t size_max) {
  if (!cache_.Use(digest)) return std::nullopt;
  auto bytes = cache_.Read(digest, size_max);
  if (bytes) return std::move(*bytes);
  spdlog::warn("cached_file_removed reason={}", LogText(bytes.error().message));
  cache_.Remove(digest);
  return std::nullopt;
}

Result<std::string> BlobFetcher::DownloadToMemory(const Wanted& wanted) {
  std::string bytes;
  const auto add = [&](std::string_view piece) -> Result<void> {
    bytes += piece;
    return {};
  };
  const auto done = Download(wanted, {[&] { return uint64_t{bytes.size()}; }, add});
  if (!done) return done.error();
  return bytes;
}

Result<void> BlobFetcher::Download(const Wanted& wanted, const Sink& sink) {
  const std::string what = fmt::format("fetch file {}", wanted.digest.Hex());
  Backoff backoff(seed_);
  auto progress_at = std::chrono::steady_clock::now();
  while (true) {
    const uint64_t before = sink.size();
    proto::DownloadRequest request;
    request.set_digest(WriteDigest(wanted.digest));
    request.set_package(WriteDigest(wanted.package));
    request.set_offset(before);
    request.set_suspect(wanted.suspect);
    std::optional<uint64_t> size;
    const auto take = [&](const proto::DownloadChunk& chunk) -> Result<void> {
      // Any number of them could follow.
      if (size && chunk.data().empty())
        return Failed(fmt::format("cannot {}: the coordinator sent a chunk without data", what));
      if (!size) size = chunk.size();
      on_bytes_(chunk.data().size());
      const bool fits =
          *size <= wanted.size_max && sink.size() <= *size && chunk.data().size() <= *size - sink.size();
      return fits ? sink.add(chunk.data())
                  : Failed(fmt::format("cannot {}: it is larger than announced", what));
    };
    Result<void> added;
    grpc::Status status = ReceiveBlob({channel_, stop_, patience_.stall}, request, take, added);
    if (!added) return added;
    if (status.ok() && sink.size() == size.value_or(0)) return {};
    if (status.ok()) status = {grpc::StatusCode::UNAVAILABLE, "the transfer was cut short"};
    const auto now = std::chrono::steady_clock::now();
    if (sink.size() > before) {
      progress_at = now;
      backoff.Reset();
    }
    const bool again = MayPass(status) && now - progress_at < patience_.download;
    if (again) waits_.Warn("fetch_postponed", fmt::format("reason={}", LogText(status.error_message())));
    if (!again || !Pause(stop_, backoff.Next())) return ToError(status, what);
  }
}

Result<uint64_t> BlobFetcher::FetchFile(const Digest& package, const PackageFile& file) {
  const auto begun = std::chrono::steady_clock::now();
  bool suspect = false;
  while (cache_.Size(file.digest) != file.size) {
    auto partial = cache_.Resume(file.digest, file.size);
    if (!partial) return partial.error();
    // Somebody else is fetching it. If that fails, Get fetches it.
    if (*partial == nullptr) {
      if (std::chrono::steady_clock::now() - begun > patience_.download || !Pause(stop_, kPollInterval))
        return 0;
      continue;
    }
    BlobStore::Partial& blob = **partial;
    const uint64_t before = blob.received();
    bool is_crowded = false;  // by other files that are arriving
    const auto add = [&](std::string_view piece) {
      auto added = blob.Add(piece);
      is_crowded = !added && added.error().kind == ErrorKind::kInterrupted;
      return added;
    };
    const auto done =
        Download({package, file.digest, file.size, suspect}, {[&] { return blob.received(); }, add});
    const bool may_wait = is_crowded && std::chrono::steady_clock::now() - begun <= patience_.download;
    if (may_wait && Pause(stop_, kPollInterval)) continue;
    if (!done) return done.error();
    const auto finished = blob.Finish();
    if (finished) return file.size - before;
    // What had arrived earlier was corrupt and is gone, or the coordinator's file is corrupt.
    const bool is_corrupt = finished.error().kind == ErrorKind::kBadInput;
    if (finished.error().kind == ErrorKind::kFailed || (is_corrupt && suspect)) return finished.error();
    suspect = is_corrupt;
  }
  return 0;
}

Result<uint64_t> BlobFetcher::FetchPackage(const Digest& digest) {
  const auto manifest = Get(digest, digest, kManifestBytesMax);
  if (!manifest) return manifest.error();
  const auto package = DecodeScenePackage(*manifest);
  if (!package) return package.error();
  std::set<PackageFile> files;
  uint64_t total = 0;
  for (const auto& [path, file] : package->files) {
    if (file.size <= kSceneFileSizeMax && files.insert(file).second) total += file.size;
  }
  // Otherwise the first would be evicted for the last.
  if (total > cache_.bytes_max()) return 0;
  const std::vector<PackageFile> queue(files.begin(), files.end());
  std::atomic<size_t> taken{0};
  std::atomic<uint64_t> fetched{0};
  std::mutex mutex;
  std::optional<Error> error;
  const auto fetch_next = [&] {
    for (size_t next = taken++; next < queue.size() && !stop_.stop_requested(); next = taken++) {
      const auto done = FetchFile(digest, queue[next]);
      if (done) {
        fetched += *done;
        continue;
      }
      const std::lock_guard lock(mutex);
      error = done.error();
      taken = queue.size();
    }
  };
  ThreadGroup threads([&](Error why) {
    const std::lock_guard lock(mutex);
    error = std::move(why);
    taken = queue.size();
  });
  const size_t count = std::min(kParallelDownloads, queue.size());
  // With fewer threads it takes longer.
  for (size_t i = 1; i < count && threads.Start(fetch_next); ++i) {
  }
  fetch_next();
  threads.Join();
  if (error) return *error;
  return fetched.load();
}

}  // namespace tessera
