#include "worker/blob_fetcher.h"

#include <fmt/format.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "language/file_source.h"
#include "proto/blobs.grpc.pb.h"
#include "wire/channel.h"
#include "wire/convert.h"
#include "worker/pause.h"
#include "worker_core/backoff.h"

namespace tessera {
namespace {

// A scene whose file does not come for so long counts as failed; the coordinator decides what then.
constexpr std::chrono::minutes kDownloadPatience{2};

// Appends to `bytes` what comes from its end on. OK: all of it is there.
grpc::Status Receive(proto::Blobs::Stub& stub, grpc::ClientContext& context, const Digest& digest,
                     uint64_t size_max, std::string& bytes) {
  proto::DownloadRequest request;
  request.set_digest(WriteDigest(digest));
  request.set_offset(bytes.size());
  const auto reader = stub.Download(&context, request);
  proto::DownloadChunk chunk;
  uint64_t size = 0;
  for (bool first = true; reader->Read(&chunk); first = false) {
    if (first) size = chunk.size();
    if (size > size_max || chunk.data().size() > size - bytes.size()) {
      context.TryCancel();
      reader->Finish();
      return {grpc::StatusCode::OUT_OF_RANGE, fmt::format("it is larger than {} bytes", size_max)};
    }
    if (first) bytes.reserve(size);
    bytes += chunk.data();
  }
  const grpc::Status status = reader->Finish();
  if (status.ok() && bytes.size() != size) return {grpc::StatusCode::UNAVAILABLE, "it was cut short"};
  return status;
}

}  // namespace

Result<std::string> BlobFetcher::Get(const Digest& digest, uint64_t size_max) {
  if (auto cached = cache_.Get(digest)) {
    if (cached->size() <= size_max) return std::move(*cached);
  }
  auto bytes = Download(digest, std::min(size_max, kSceneFileSizeMax));
  if (!bytes) return bytes;
  if (Sha256(*bytes) != digest) return Failed("a file came damaged from the coordinator");
  if (auto kept = cache_.Put(digest, *bytes); !kept)
    spdlog::warn("cache reason=\"{}\"", kept.error().message);
  return bytes;
}

Result<std::string> BlobFetcher::Download(const Digest& digest, uint64_t size_max) {
  const auto stub = proto::Blobs::NewStub(channel_);
  Backoff backoff(seed_);
  std::string bytes;
  auto heard = std::chrono::steady_clock::now();
  while (true) {
    const size_t before = bytes.size();
    grpc::ClientContext context;
    const std::stop_callback on_stop(stop_, [&context] { context.TryCancel(); });
    const grpc::Status status = Receive(*stub, context, digest, size_max, bytes);
    if (status.ok()) return bytes;
    const auto now = std::chrono::steady_clock::now();
    if (bytes.size() > before) {
      heard = now;
      backoff.Reset();
    }
    const bool again = IsTransient(status) && now - heard < kDownloadPatience;
    if (!again || !Pause(stop_, backoff.Next()))
      return ToError(status, fmt::format("fetch file {}", digest.Hex()));
  }
}

}  // namespace tessera
