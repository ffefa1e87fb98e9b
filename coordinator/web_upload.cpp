#include "coordinator/web_upload.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"

namespace tessera {
namespace {

// The steps run on threads for files, one after the other. Each keeps the upload, whose connection may end
// meanwhile.
class WebUpload final : public BodySink, public std::enable_shared_from_this<WebUpload> {
 public:
  using Answer = std::shared_ptr<LaterAnswer>;
  WebUpload(const WebUploadParts& parts, Principal caller, const Digest& digest, uint64_t size,
            uint64_t offset)
      : parts_(parts),
        caller_(std::move(caller)),
        place_(parts_.load.uploads.Take(caller_)),
        digest_(digest),
        size_(size),
        offset_(offset) {}
  ~WebUpload() override {
    if (upload_ != nullptr) Audit({grpc::StatusCode::CANCELLED, "the upload ended early"});
  }
  WebUpload(const WebUpload&) = delete;
  WebUpload& operator=(const WebUpload&) = delete;

  void Take(std::string piece, bool is_last, Answer answer) override {
    // What was sent earlier may have to be hashed.
    const bool is_resumed = upload_ == nullptr && offset_ > 0;
    const bool is_lengthy = is_resumed || (is_last && size_ > kBriefBytesMax);
    (is_lengthy ? parts_.threads.lengthy : parts_.threads.brief)
        .Post([self = shared_from_this(), piece = std::move(piece), is_last, answer = std::move(answer)] {
          const auto stored = GuardedResult([&] { return self->Store(piece); });
          if (stored && !*stored && !is_last) return answer->Give(HttpResponse::Continue());
          const Result<void> ended = !stored   ? stored.error()
                                     : *stored ? Result<void>()
                                               : GuardedResult([&] { return self->upload_->Finish(); });
          answer->Give(self->End(ended));
        });
  }

 private:
  // Returns whether the blob is there already.
  Result<bool> Store(const std::string& piece) {
    if (upload_ == nullptr) {
      if (!place_) return Error{ErrorKind::kInterrupted, place_.error().message + "; wait for one to end"};
      if (parts_.blobs.Has(digest_)) return true;
      auto begun = parts_.blobs.Begin(digest_, size_, offset_);
      if (!begun) return begun.error();
      upload_ = std::move(*begun);
    }
    if (const auto added = upload_->Add(piece); !added) return added.error();
    parts_.load.bytes_in += piece.size();
    return false;
  }
  HttpResponse End(const Result<void>& ended) {
    upload_.reset();
    if (ended) {
      Audit(grpc::Status::OK);
      HttpResponse response = HttpResponse::Plain(200, "{}\n");
      response.type = kJsonText;
      return response;
    }
    const Error& error = ended.error();
    Audit({grpc::StatusCode::ABORTED, error.message});
    switch (error.kind) {
      case ErrorKind::kBadInput: return HttpResponse::JsonError(400, error.message);
      case ErrorKind::kInterrupted: return HttpResponse::JsonError(503, error.message);
      case ErrorKind::kFailed: break;
    }
    return HttpResponse::JsonError(507, error.message);
  }
  void Audit(const grpc::Status& status) const {
    CallGate::Audit(caller_, RuleFor("Blobs.Upload"), fmt::format("file={} bytes={}", digest_.Hex(), size_),
                    status, parts_.load.failed);
  }

  const WebUploadParts parts_;
  const Principal caller_;
  const Result<MemberPlaces::Place> place_;
  const Digest digest_;
  const uint64_t size_, offset_;
  std::unique_ptr<BlobStore::Partial> upload_;
};

}  // namespace

std::shared_ptr<BodySink> MakeWebUpload(const WebUploadParts& parts, Principal caller, const Digest& digest,
                                        uint64_t size, uint64_t offset) {
  return std::make_shared<WebUpload>(parts, std::move(caller), digest, size, offset);
}

}  // namespace tessera
