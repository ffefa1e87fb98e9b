#include "coordinator/blob_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "coordinator/call_gate.h"
#include "proto/terms.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"

namespace tessera {
namespace {

// Running at the same time, each with an open file and 2 MB of memory. They fill any network.
constexpr int kTransfersMax = 64;

// Deletes itself when the call is over.
class UploadCall final : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  UploadCall(const BlobStore& blobs, TransferLoad& load, grpc::CallbackServerContext& context)
      : blobs_(blobs), load_(load), watched_(load.stall_watch.Watch(context)) {
    if (++load_.transfers > kTransfersMax) {
      Finish({grpc::StatusCode::UNAVAILABLE, "too many transfers are running; try again"});
      return;
    }
    ReadNext();
  }
  ~UploadCall() override { --load_.transfers; }

 private:
  void ReadNext() {
    watched_->BeginWait();
    StartRead(&bytes_);
  }
  void OnReadDone(bool ok) override {
    watched_->EndWait();
    const auto status = ok ? Take() : End();
    if (status) {
      Finish(*status);
    } else {
      ReadNext();
    }
  }
  void OnDone() override {
    watched_->End();
    delete this;
  }

  // Stores a chunk. Returns the answer once it is known.
  std::optional<grpc::Status> Take() {
    const auto parsed = ParseMessage(bytes_, RuleFor("Blobs.Upload").limits, chunk_);
    if (!parsed.ok()) return parsed;
    if (upload_ == nullptr) {
      const auto digest = ReadDigest(chunk_.digest(), "digest");
      if (!digest) return ToStatus(digest.error());
      if (blobs_.Has(*digest)) return grpc::Status::OK;
      auto begun = blobs_.Begin(*digest, chunk_.size(), chunk_.offset());
      if (!begun) return Refusal(begun.error());
      upload_ = std::move(*begun);
    }
    if (static_cast<int64_t>(chunk_.data().size()) > kChunkBytesMax) {
      return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT,
                          "message refused: data is longer than a chunk may be");
    }
    if (const auto added = upload_->Add(chunk_.data()); !added) return Refusal(added.error());
    load_.bytes_in += chunk_.data().size();
    return std::nullopt;
  }
  grpc::Status End() {
    if (upload_ == nullptr)
      return {grpc::StatusCode::INVALID_ARGUMENT, "message refused: the upload has no chunks"};
    // What has arrived is kept for the next attempt.
    if (!upload_->IsWhole()) return {grpc::StatusCode::DATA_LOSS, "the upload ended early"};
    const auto finished = upload_->Finish();
    return finished ? grpc::Status::OK : Refusal(finished.error());
  }
  static grpc::Status Refusal(const Error& error) {
    switch (error.kind) {
      case ErrorKind::kBadInput: return {grpc::StatusCode::DATA_LOSS, error.message};
      case ErrorKind::kInterrupted: return {grpc::StatusCode::UNAVAILABLE, error.message};
      case ErrorKind::kFailed: break;
    }
    return {grpc::StatusCode::RESOURCE_EXHAUSTED, error.message};
  }

  const BlobStore& blobs_;
  TransferLoad& load_;
  const std::shared_ptr<StallWatch::Call> watched_;
  grpc::ByteBuffer bytes_;
  proto::UploadChunk chunk_;
  std::unique_ptr<BlobStore::Partial> upload_;
};

// Deletes itself when the call is over.
class DownloadCall final : public grpc::ServerWriteReactor<proto::DownloadChunk> {
 public:
  DownloadCall(const BlobStore& blobs, const proto::DownloadRequest& request, TransferLoad& load,
               grpc::CallbackServerContext& context)
      : load_(load), watched_(load.stall_watch.Watch(context)) {
    if (++load_.transfers > kTransfersMax) {
      Finish({grpc::StatusCode::RESOURCE_EXHAUSTED, "too many transfers are running; try again"});
      return;
    }
    const grpc::Status status = Open(blobs, request);
    if (!status.ok()) {
      Finish(status);
      return;
    }
    chunk_.set_size(size_);
    SendNext();
  }
  ~DownloadCall() override { --load_.transfers; }

 private:
  grpc::Status Open(const BlobStore& blobs, const proto::DownloadRequest& request) {
    const auto digest = ReadDigest(request.digest(), "digest");
    if (!digest) return ToStatus(digest.error());
    const auto size = blobs.Use(*digest);
    if (!size) return {grpc::StatusCode::NOT_FOUND, fmt::format("there is no blob {}", digest->Hex())};
    if (request.offset() > *size)
      return {grpc::StatusCode::OUT_OF_RANGE, "the offset is beyond the end of the blob"};
    size_ = *size;
    left_ = *size - request.offset();
    file_.open(blobs.Path(*digest), std::ios::binary);
    file_.seekg(static_cast<std::streamoff>(request.offset()));
    if (!file_) return {grpc::StatusCode::UNAVAILABLE, "the blob cannot be opened"};
    return grpc::Status::OK;
  }
  void SendNext() {
    std::string& data = *chunk_.mutable_data();
    data.resize(std::min(left_, static_cast<uint64_t>(kChunkBytesMax)));
    if (!file_.read(data.data(), static_cast<std::streamsize>(data.size()))) {
      Finish({grpc::StatusCode::UNAVAILABLE, "the blob cannot be read"});
      return;
    }
    left_ -= data.size();
    load_.bytes_out += data.size();
    watched_->BeginWait();
    StartWrite(&chunk_);
  }
  void OnWriteDone(bool ok) override {
    watched_->EndWait();
    if (!ok) {
      Finish(grpc::Status::CANCELLED);
    } else if (left_ == 0) {
      Finish(grpc::Status::OK);
    } else {
      chunk_.clear_size();
      SendNext();
    }
  }
  void OnDone() override {
    watched_->End();
    delete this;
  }

  TransferLoad& load_;
  const std::shared_ptr<StallWatch::Call> watched_;
  std::ifstream file_;
  uint64_t size_ = 0, left_ = 0;
  proto::DownloadChunk chunk_;
};

}  // namespace

BlobService::BlobService(const CallGate& gate, const BlobStore& blobs) : gate_(gate), blobs_(blobs) {
  const auto serve = [this](auto method, const CallRule& rule) {
    MarkMethodCallback(MethodIndex(rule), GuardedMethod(this, rule, method));
  };
  serve(&BlobService::FindMissing, RuleFor("Blobs.FindMissing"));
  serve(&BlobService::Upload, RuleFor("Blobs.Upload"));
  serve(&BlobService::Download, RuleFor("Blobs.Download"));
}

grpc::ServerUnaryReactor* BlobService::FindMissing(grpc::CallbackServerContext* context,
                                                   const proto::FindMissingRequest* request,
                                                   proto::FindMissingAnswer* answer) {
  return gate_.Unary(context, RuleFor("Blobs.FindMissing"), [=, this](const UnaryCall& call) {
    if (request->digests_size() > kDigestsPerCallMax) {
      return call.Finish(ToStatus(BadInput(
          fmt::format("message refused: too many digests in one call (limit {})", kDigestsPerCallMax))));
    }
    for (const std::string& bytes : request->digests()) {
      const auto digest = ReadDigest(bytes, "digest");
      if (!digest) return call.Finish(ToStatus(digest.error()));
      if (blobs_.Use(*digest)) continue;
      answer->add_missing(bytes);
      answer->add_held(blobs_.Arrived(*digest));
    }
    call.Finish(grpc::Status::OK);
  });
}

grpc::ServerReadReactor<grpc::ByteBuffer>* BlobService::Upload(grpc::CallbackServerContext* context,
                                                               proto::UploadAnswer*) {
  using Reactor = grpc::ServerReadReactor<grpc::ByteBuffer>;
  return gate_.Serve<Reactor>(context, RuleFor("Blobs.Upload"), [=, this](const Principal&) {
    return new UploadCall(blobs_, load_, *context);
  });
}

grpc::ServerWriteReactor<proto::DownloadChunk>* BlobService::Download(grpc::CallbackServerContext* context,
                                                                      const proto::DownloadRequest* request) {
  using Reactor = grpc::ServerWriteReactor<proto::DownloadChunk>;
  return gate_.Serve<Reactor>(context, RuleFor("Blobs.Download"), [=, this](const Principal&) {
    return new DownloadCall(blobs_, *request, load_, *context);
  });
}

}  // namespace tessera
