// One attempt to download a blob.
#pragma once

#include <grpcpp/support/status.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "proto/blobs.grpc.pb.h"
#include "renderer/util/result.h"

namespace tessera {

struct BlobStream {
  std::shared_ptr<grpc::Channel> channel;
  std::stop_token stop;
  // Without a chunk for this long the attempt ends with DEADLINE_EXCEEDED: the coordinator may answer pings
  // and send nothing.
  std::chrono::milliseconds stall_max;
};

// Calls `on_chunk` for each chunk, which ends the attempt with an error. Returns the status of the call, or
// that error in `refused`.
grpc::Status ReceiveBlob(const BlobStream& stream, const proto::DownloadRequest& request,
                         const std::function<Result<void>(const proto::DownloadChunk&)>& on_chunk,
                         Result<void>& refused);

}  // namespace tessera
