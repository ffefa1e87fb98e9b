// Serves proto/blobs.proto from the blob store. Files are read, hashed and written on threads of their own.
// Thread safe.
#pragma once

#include <atomic>
#include <vector>

#include "coordinator/call_gate.h"
#include "coordinator/member_places.h"
#include "coordinator/package_files.h"
#include "coordinator/stall_watch.h"
#include "proto/blobs.grpc.pb.h"
#include "proto/blobs/blob_store.h"

namespace tessera {

struct FileThreads;
struct Principal;

// Transfers that run at the same time, each with an open file and 2 MB of memory. They fill any network, and
// so do those of one member.
constexpr MemberPlaces::Limits kUploadPlaces{48, 12}, kDownloadPlaces{48, 12};
// Syncing more takes long.
constexpr uint64_t kBriefBytesMax = uint64_t{16} << 20;

struct TransferLoad {
  // Apart, so that uploads of clients do not keep scenes from workers.
  MemberPlaces uploads{kUploadPlaces, "transfers are running"};
  MemberPlaces downloads{kDownloadPlaces, "transfers are running"};
  std::atomic<uint64_t> bytes_in{0}, bytes_out{0};
  RareLog failed{CallGate::kLogInterval, CallGate::kFailuresLogged};
  StallWatch stall_watch;
};

class BlobService final : public proto::Blobs::Service {
 public:
  // The threads must run until every call has ended.
  BlobService(const CallGate& gate, const BlobStore& blobs, FileThreads& threads);
  // Bytes of blobs transferred since the start.
  uint64_t bytes_in() const { return load_.bytes_in; }
  uint64_t bytes_out() const { return load_.bytes_out; }
  // For transfers by another way.
  TransferLoad& load() { return load_; }

  grpc::ServerUnaryReactor* FindMissing(grpc::CallbackServerContext* context,
                                        const proto::FindMissingRequest* request,
                                        proto::FindMissingAnswer* answer);
  grpc::ServerReadReactor<grpc::ByteBuffer>* Upload(grpc::CallbackServerContext* context,
                                                    proto::UploadAnswer* answer);
  grpc::ServerWriteReactor<proto::DownloadChunk>* Download(grpc::CallbackServerContext* context,
                                                           const proto::DownloadRequest* request);

 private:
  // Whether the caller may fetch the blob.
  grpc::Status AdmitFetch(const Principal& caller, const proto::DownloadRequest& request,
                          const Digest& digest);
  grpc::Status ListMissing(const std::vector<Digest>& digests, proto::FindMissingAnswer& answer) const;

  const CallGate& gate_;
  const BlobStore& blobs_;
  FileThreads& threads_;
  TransferLoad load_;
  PackageFiles packages_{blobs_};
};

}  // namespace tessera
