#include "worker/blob_stream.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>

namespace tessera {
namespace {

// The events of one call, one after another.
class Events {
 public:
  ~Events() {
    queue_.Shutdown();
    void* tag = nullptr;
    bool ok = false;
    while (queue_.Next(&tag, &ok)) {
    }
  }
  grpc::CompletionQueue& queue() { return queue_; }
  void* tag() { return this; }
  enum class Outcome { kDone, kFailed, kLate };
  Outcome Await(std::chrono::milliseconds patience) {
    void* tag = nullptr;
    bool ok = false;
    const auto next = queue_.AsyncNext(&tag, &ok, std::chrono::system_clock::now() + patience);
    if (next == grpc::CompletionQueue::TIMEOUT) return Outcome::kLate;
    return ok ? Outcome::kDone : Outcome::kFailed;
  }
  // However long it takes.
  void AwaitEvent() {
    void* tag = nullptr;
    bool ok = false;
    queue_.Next(&tag, &ok);
  }

 private:
  grpc::CompletionQueue queue_;
};

}  // namespace

grpc::Status ReceiveBlob(const BlobStream& stream, const proto::DownloadRequest& request,
                         const std::function<Result<void>(const proto::DownloadChunk&)>& on_chunk,
                         Result<void>& refused) {
  grpc::ClientContext context;
  const std::stop_callback on_stop(stream.stop, [&context] { context.TryCancel(); });
  const auto stub = proto::Blobs::NewStub(stream.channel);
  Events events;
  const auto reader = stub->AsyncDownload(&context, request, &events.queue(), events.tag());
  proto::DownloadChunk chunk;
  bool is_stalled = false;
  // The first event is that the call has started.
  for (bool has_chunk = false;; has_chunk = true) {
    auto outcome = events.Await(stream.stall_max);
    if (outcome == Events::Outcome::kLate) {
      is_stalled = true;
      context.TryCancel();
      events.AwaitEvent();
      break;
    }
    if (outcome == Events::Outcome::kFailed) break;
    if (has_chunk) refused = on_chunk(chunk);
    if (!refused) {
      context.TryCancel();
      break;
    }
    reader->Read(&chunk, events.tag());
  }
  grpc::Status status;
  reader->Finish(&status, events.tag());
  events.AwaitEvent();
  if (is_stalled) return {grpc::StatusCode::DEADLINE_EXCEEDED, "the coordinator sends nothing of the file"};
  return status;
}

}  // namespace tessera
