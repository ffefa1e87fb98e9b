// Serves proto/blobs.proto from the blob store. Thread safe.
#pragma once

#include <atomic>

#include "proto/blobs.grpc.pb.h"
#include "store/blob_store.h"

namespace tessera {

class BlobService final : public proto::Blobs::CallbackService {
 public:
  explicit BlobService(const BlobStore& blobs) : blobs_(blobs) {}

  grpc::ServerUnaryReactor* FindMissing(grpc::CallbackServerContext* context,
                                        const proto::FindMissingRequest* request,
                                        proto::FindMissingAnswer* answer) override;
  grpc::ServerReadReactor<proto::UploadChunk>* Upload(grpc::CallbackServerContext* context,
                                                      proto::UploadAnswer* answer) override;
  grpc::ServerWriteReactor<proto::DownloadChunk>* Download(grpc::CallbackServerContext* context,
                                                           const proto::DownloadRequest* request) override;

 private:
  const BlobStore& blobs_;
  std::atomic<int> transfers_{0};
};

}  // namespace tessera
