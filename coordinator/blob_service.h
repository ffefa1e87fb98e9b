// Serves proto/blobs.proto from the blob store. Thread safe.
#pragma once

#include <atomic>

#include "coordinator/stall_watch.h"
#include "proto/blobs.grpc.pb.h"
#include "proto/blobs/blob_store.h"

namespace tessera {

class CallGate;

struct TransferLoad {
  std::atomic<int> transfers{0};  // running now
  std::atomic<uint64_t> bytes_in{0}, bytes_out{0};
  StallWatch stall_watch;
};

class BlobService final : public proto::Blobs::Service {
 public:
  BlobService(const CallGate& gate, const BlobStore& blobs);
  // Bytes of blobs transferred since the start.
  uint64_t bytes_in() const { return load_.bytes_in; }
  uint64_t bytes_out() const { return load_.bytes_out; }

  grpc::ServerUnaryReactor* FindMissing(grpc::CallbackServerContext* context,
                                        const proto::FindMissingRequest* request,
                                        proto::FindMissingAnswer* answer);
  grpc::ServerReadReactor<grpc::ByteBuffer>* Upload(grpc::CallbackServerContext* context,
                                                    proto::UploadAnswer* answer);
  grpc::ServerWriteReactor<proto::DownloadChunk>* Download(grpc::CallbackServerContext* context,
                                                           const proto::DownloadRequest* request);

 private:
  const CallGate& gate_;
  const BlobStore& blobs_;
  TransferLoad load_;
};

}  // namespace tessera
