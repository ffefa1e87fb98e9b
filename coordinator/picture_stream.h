// One client that fetches a picture.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "coordinator/member_places.h"
#include "coordinator/open_calls.h"
#include "coordinator/stall_watch.h"
#include "coordinator/store/data_dir.h"
#include "coordinator/store/picture_store.h"
#include "coordinator/task_pool.h"
#include "proto/jobs.grpc.pb.h"
#include "renderer/util/readable_file.h"
#include "renderer/util/result.h"

namespace tessera {

// What the streams of a coordinator share.
struct PictureStreams {
  const DataDir& directory;  // for temporary files
  TaskPool& threads;         // for reading files
  StallWatch stall_watch{};
  // Each stream has a file and a chunk.
  MemberPlaces open{{64, 16}, "pictures are being fetched"};
  // Of streams that wait for the thread that makes previews and reads pictures. Each keeps sums that the
  // frame has replaced.
  MemberPlaces waiting{{16, 4}, "pictures are waiting to be made"};
};

// Deletes itself when the call is over. Exactly one of Refuse and Send is called, once, from any thread.
// Holds no more than a chunk in memory while it sends: larger bytes go to a temporary file.
class PictureStream final : public grpc::ServerWriteReactor<proto::PictureChunk> {
 public:
  PictureStream(PictureStreams& streams, LastingCall call);
  const Principal& caller() const { return call_.caller(); }
  // Takes a place among the streams, until the call is over.
  void HoldPlace(MemberPlaces::Place place) { place_ = std::move(place); }
  // Whether the client has gone: nobody will read the picture.
  bool is_cancelled() const { return is_cancelled_; }
  void Refuse(const grpc::Status& status);
  // Sends a picture, or the reason why there is none.
  void Send(Result<std::string> bytes);
  void Send(Result<StoredPicture> picture);

 private:
  // Keeps the picture until it is sent, in memory or in a file.
  Result<void> Store(std::string bytes);
  Result<void> Store(StoredPicture picture);
  // `picture`: bytes or a file.
  template <typename Picture>
  void SendStored(Result<Picture> picture);
  void SendNext();
  grpc::Status ReadNext();
  void OnWriteDone(bool ok) override;
  void OnCancel() override { is_cancelled_ = true; }
  void OnDone() override;

  PictureStreams& streams_;
  MemberPlaces::Place place_;
  const LastingCall call_;
  const std::shared_ptr<StallWatch::Call> watched_;
  std::atomic<bool> is_cancelled_{false};
  std::string bytes_;  // unless they are in a file
  std::optional<ReadableFile> file_;
  uint64_t size_ = 0, sent_ = 0;
  proto::PictureChunk chunk_;
};

}  // namespace tessera
