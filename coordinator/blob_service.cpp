#include "coordinator/blob_service.h"

#include <fmt/format.h>

#include <fstream>
#include <functional>

#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"
#include "coordinator/missing_blobs.h"
#include "coordinator/task_pool.h"
#include "proto/terms.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"

namespace tessera {
namespace {

// Deletes itself when the call is over. Each step runs on a thread for files, one after the other.
class UploadCall final : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  UploadCall(const BlobStore& blobs, FileThreads& threads, TransferLoad& load, LastingCall call)
      : blobs_(blobs),
        threads_(threads),
        load_(load),
        call_(std::move(call)),
        watched_(load.stall_watch.Watch(call_.context())) {
    auto place = load_.uploads.Take(call_.caller());
    if (!place) {
      Answer(TryAgain(place.error().message));
      return;
    }
    place_ = std::move(*place);
    ReadNext();
  }

 private:
  void ReadNext() {
    watched_->BeginWait();
    StartRead(&bytes_);
  }
  void OnReadDone(bool ok) override {
    watched_->EndWait();
    const bool is_lengthy = !ok && upload_ != nullptr && upload_->received() > kBriefBytesMax;
    (is_lengthy ? threads_.lengthy : threads_.brief).Post([this, ok] {
      ok ? Parse() : Run([this] { return End(); });
    });
  }
  void OnDone() override {
    watched_->End();
    delete this;
  }

  void Parse() {
    const grpc::Status parsed =
        GuardedStatus([this] { return ParseMessage(bytes_, RuleFor("Blobs.Upload").limits, chunk_); });
    if (!parsed.ok()) return Answer(parsed);
    const auto take = [this] { Run([this] { return Take(); }); };
    // What was sent earlier may have to be hashed.
    const bool is_resumed = upload_ == nullptr && chunk_.offset() > 0;
    is_resumed ? threads_.lengthy.Post(take) : take();
  }
  // Gives the answer of a step, or reads the next chunk if it has none.
  template <typename Step>
  void Run(Step step) {
    std::optional<grpc::Status> answer;
    const grpc::Status guarded = GuardedStatus([&] {
      answer = step();
      return grpc::Status::OK;
    });
    if (!guarded.ok()) answer = guarded;
    answer ? Answer(*answer) : ReadNext();
  }
  void Answer(const grpc::Status& status) {
    CallGate::Audit(call_.caller(), RuleFor("Blobs.Upload"), details_, status, load_.failed);
    watched_->BeginWait();
    Finish(Shortened(status));
  }
  // Stores a chunk. Returns the answer once it is known.
  std::optional<grpc::Status> Take() {
    if (const grpc::Status admitted = call_.Recheck(); !admitted.ok()) return admitted;
    // It would keep its place and bring nothing.
    if (upload_ != nullptr && chunk_.data().empty())
      return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "message refused: a chunk without data");
    if (upload_ == nullptr) {
      const auto digest = ReadDigest(chunk_.digest(), "digest");
      if (!digest) return ToStatus(digest.error());
      details_ = fmt::format("file={} bytes={}", digest->Hex(), chunk_.size());
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
    if (const grpc::Status admitted = call_.Recheck(); !admitted.ok()) return admitted;
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
      case ErrorKind::kInterrupted: return TryAgain(error.message);
      case ErrorKind::kFailed: break;
    }
    return {grpc::StatusCode::RESOURCE_EXHAUSTED, error.message};
  }

  const BlobStore& blobs_;
  FileThreads& threads_;
  TransferLoad& load_;
  MemberPlaces::Place place_;
  const LastingCall call_;
  const std::shared_ptr<StallWatch::Call> watched_;
  grpc::ByteBuffer bytes_;
  proto::UploadChunk chunk_;
  std::unique_ptr<BlobStore::Partial> upload_;
  std::string details_;  // for the audit log
};

// Deletes itself when the call is over. Each step runs on a thread for files, one after the other.
class DownloadCall final : public grpc::ServerWriteReactor<proto::DownloadChunk> {
 public:
  // Whether the caller may fetch the blob of the request.
  using Admit = std::function<grpc::Status(const Principal&, const proto::DownloadRequest&, const Digest&)>;
  DownloadCall(const BlobStore& blobs, FileThreads& threads, const proto::DownloadRequest& request,
               TransferLoad& load, LastingCall call, Admit admit)
      : blobs_(blobs),
        threads_(threads),
        load_(load),
        call_(std::move(call)),
        watched_(load.stall_watch.Watch(call_.context())) {
    auto place = load_.downloads.Take(call_.caller());
    if (!place) {
      Finish(Shortened(TryAgain(place.error().message)));
      return;
    }
    place_ = std::move(*place);
    threads_.brief.Post([this, request, admit = std::move(admit)] {
      bool is_lengthy = false;
      const grpc::Status admitted = GuardedStatus([&] { return Check(request, admit, is_lengthy); });
      if (!admitted.ok()) return Refuse(Shortened(admitted));
      is_lengthy ? threads_.lengthy.Post([this, request] { Begin(request); }) : Begin(request);
    });
  }

 private:
  // `is_lengthy`: whether the blob has to be hashed.
  grpc::Status Check(const proto::DownloadRequest& request, const Admit& admit, bool& is_lengthy) {
    const auto digest = ReadDigest(request.digest(), "digest");
    if (!digest) return ToStatus(digest.error());
    if (const grpc::Status admitted = admit(call_.caller(), request, *digest); !admitted.ok())
      return admitted;
    if (request.suspect()) blobs_.Suspect(*digest);
    is_lengthy = blobs_.Look(*digest) == BlobStore::Presence::kUnknown;
    return grpc::Status::OK;
  }
  void Begin(const proto::DownloadRequest& request) {
    const grpc::Status status = GuardedStatus([&] { return Open(request); });
    if (!status.ok()) return Refuse(status);
    chunk_.set_size(size_);
    SendNext();
  }
  grpc::Status Open(const proto::DownloadRequest& request) {
    const auto digest = ReadDigest(request.digest(), "digest");
    if (!digest) return ToStatus(digest.error());
    const auto size = blobs_.UseVerified(*digest);
    if (!size) {
      return {
          grpc::StatusCode::NOT_FOUND,
          fmt::format("the coordinator does not have the file {} or found it corrupt; submit the scene again",
                      digest->Hex())};
    }
    if (request.offset() > *size)
      return {grpc::StatusCode::OUT_OF_RANGE, "the offset is beyond the end of the blob"};
    size_ = *size;
    left_ = *size - request.offset();
    file_.open(blobs_.Path(*digest), std::ios::binary);
    file_.seekg(static_cast<std::streamoff>(request.offset()));
    if (!file_) return {grpc::StatusCode::UNAVAILABLE, "the blob cannot be opened"};
    return grpc::Status::OK;
  }
  void SendNext() {
    const grpc::Status read = GuardedStatus([this] { return ReadNext(); });
    if (!read.ok()) return Refuse(read);
    watched_->BeginWait();
    StartWrite(&chunk_);
  }
  grpc::Status ReadNext() {
    if (const grpc::Status admitted = call_.Recheck(); !admitted.ok()) return admitted;
    std::string& data = *chunk_.mutable_data();
    data.resize(std::min(left_, static_cast<uint64_t>(kChunkBytesMax)));
    if (!file_.read(data.data(), static_cast<std::streamsize>(data.size())))
      return {grpc::StatusCode::UNAVAILABLE, "the blob cannot be read"};
    left_ -= data.size();
    load_.bytes_out += data.size();
    return grpc::Status::OK;
  }
  void Refuse(const grpc::Status& status) {
    watched_->BeginWait();
    Finish(status);
  }
  void OnWriteDone(bool ok) override {
    watched_->EndWait();
    if (!ok) {
      Finish(grpc::Status::CANCELLED);
    } else if (left_ == 0) {
      Finish(grpc::Status::OK);
    } else {
      threads_.brief.Post([this] {
        chunk_.clear_size();
        SendNext();
      });
    }
  }
  void OnDone() override {
    watched_->End();
    delete this;
  }

  const BlobStore& blobs_;
  FileThreads& threads_;
  TransferLoad& load_;
  MemberPlaces::Place place_;
  const LastingCall call_;
  const std::shared_ptr<StallWatch::Call> watched_;
  std::ifstream file_;
  uint64_t size_ = 0, left_ = 0;
  proto::DownloadChunk chunk_;
};

}  // namespace

BlobService::BlobService(const CallGate& gate, const BlobStore& blobs, FileThreads& threads)
    : gate_(gate), blobs_(blobs), threads_(threads) {
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
    std::vector<Digest> digests;
    for (const std::string& bytes : request->digests()) {
      const auto digest = ReadDigest(bytes, "digest");
      if (!digest) return call.Finish(ToStatus(digest.error()));
      digests.push_back(*digest);
    }
    threads_.brief.Post([=, this] {
      const auto list = [=, this] {
        call.Finish(GuardedStatus([&] { return ListMissing(digests, *answer); }));
      };
      IsQuickToFind(blobs_, digests) ? list() : threads_.lengthy.Post(list);
    });
  });
}

grpc::Status BlobService::ListMissing(const std::vector<Digest>& digests,
                                      proto::FindMissingAnswer& answer) const {
  const auto missing = tessera::FindMissing(blobs_, digests);
  if (!missing) return TryAgain(missing.error().message);
  for (const Digest& digest : digests) {
    const auto found = missing->find(digest);
    if (found == missing->end()) continue;
    answer.add_missing(WriteDigest(digest));
    answer.add_held(found->second);
  }
  return grpc::Status::OK;
}

grpc::ServerReadReactor<grpc::ByteBuffer>* BlobService::Upload(grpc::CallbackServerContext* context,
                                                               proto::UploadAnswer*) {
  using Reactor = grpc::ServerReadReactor<grpc::ByteBuffer>;
  return gate_.Serve<Reactor>(context, RuleFor("Blobs.Upload"), [=, this](LastingCall call) {
    return new UploadCall(blobs_, threads_, load_, std::move(call));
  });
}

grpc::ServerWriteReactor<proto::DownloadChunk>* BlobService::Download(grpc::CallbackServerContext* context,
                                                                      const proto::DownloadRequest* request) {
  using Reactor = grpc::ServerWriteReactor<proto::DownloadChunk>;
  return gate_.Serve<Reactor>(context, RuleFor("Blobs.Download"), [=, this](LastingCall call) {
    return new DownloadCall(blobs_, threads_, *request, load_, std::move(call),
                            [this](const Principal& caller, const proto::DownloadRequest& wanted,
                                   const Digest& digest) { return AdmitFetch(caller, wanted, digest); });
  });
}

grpc::Status BlobService::AdmitFetch(const Principal& caller, const proto::DownloadRequest& request,
                                     const Digest& digest) {
  const CallRule& rule = RuleFor("Blobs.Download");
  if (ReachOf(caller.role, rule.permission) == Reach::kEverything) return grpc::Status::OK;
  const auto package = ReadDigest(request.package(), "package");
  if (!package) return ToStatus(package.error());
  const bool is_open = gate_.core().open_jobs().HasPackage(*package);
  const auto contains = is_open ? packages_.Contains(*package, digest) : Result<bool>(false);
  if (!contains) return {grpc::StatusCode::NOT_FOUND, contains.error().message};
  if (*contains) return grpc::Status::OK;
  return gate_.Deny(
      caller, rule,
      fmt::format("{} may not fetch the file {}: it is not in the scene package {} of an open job",
                  caller.Text(), digest.Hex(), package->Hex()));
}

}  // namespace tessera
