// One client that fetches a picture.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "coordinator/open_calls.h"
#include "coordinator/stall_watch.h"
#include "coordinator/task_pool.h"
#include "proto/jobs.grpc.pb.h"
#include "renderer/util/result.h"

namespace tessera {

// What the streams of a coordinator share.
struct PictureStreams {
  std::string folder;  // for temporary files
  TaskPool& threads;   // for reading them
  StallWatch stall_watch{};
  std::atomic<int> count{0};    // of streams
  std::atomic<int> waiting{0};  // of streams whose picture is being made or read, or will be
};

// Deletes itself when the call is over. Exactly one of Refuse and Send is called, once, from any thread.
// Holds no more than a chunk in memory while it sends: a larger picture goes to a temporary file without a
// name.
class PictureStream final : public grpc::ServerWriteReactor<proto::PictureChunk> {
 public:
  PictureStream(PictureStreams& streams, LastingCall call);
  ~PictureStream() override;
  // Whether the client has gone: nobody will read the picture.
  bool is_cancelled() const { return is_cancelled_; }
  void Refuse(const grpc::Status& status);
  // Sends the bytes of a picture, or the reason why there are none.
  void Send(Result<std::string> bytes);

 private:
  Result<void> Keep(std::string bytes);
  void SendNext();
  grpc::Status ReadNext();
  void OnWriteDone(bool ok) override;
  void OnCancel() override { is_cancelled_ = true; }
  void OnDone() override;

  PictureStreams& streams_;
  const LastingCall call_;
  const std::shared_ptr<StallWatch::Call> watched_;
  std::atomic<bool> is_cancelled_{false};
  std::string bytes_;  // unless they are in the file
  int file_ = -1;
  uint64_t size_ = 0, sent_ = 0;
  proto::PictureChunk chunk_;
};

}  // namespace tessera
