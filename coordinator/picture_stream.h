// One client that fetches a picture.
#pragma once

#include <string>

#include "proto/jobs.grpc.pb.h"
#include "renderer/util/result.h"

namespace tessera {

// Deletes itself when the call is over. Exactly one of Refuse and Send is called, once, from any thread.
class PictureStream final : public grpc::ServerWriteReactor<proto::PictureChunk> {
 public:
  void Refuse(const grpc::Status& status) { Finish(status); }
  // Sends the bytes of a picture, or the reason why there are none.
  void Send(Result<std::string> bytes);

 private:
  void SendNext();
  void OnWriteDone(bool ok) override;
  void OnDone() override { delete this; }

  std::string bytes_;
  size_t sent_ = 0;
  proto::PictureChunk chunk_;
};

}  // namespace tessera
