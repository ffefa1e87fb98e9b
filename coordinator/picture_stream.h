// One client that fetches a picture.
#pragma once

#include <string>

#include "coordinator/core/farm.h"
#include "proto/jobs.grpc.pb.h"

namespace tessera {

// Deletes itself when the call is over. Exactly one of Refuse, SendFile and SendPicture is called, once, from
// any thread; the last two take long.
class PictureStream final : public grpc::ServerWriteReactor<proto::PictureChunk> {
 public:
  void Refuse(const grpc::Status& status) { Finish(status); }
  void SendFile(const std::string& path);
  void SendPicture(const FinishedPicture& picture);

 private:
  void Send(std::string bytes);
  void SendNext();
  void OnWriteDone(bool ok) override;
  void OnDone() override { delete this; }

  std::string bytes_;
  size_t sent_ = 0;
  proto::PictureChunk chunk_;
};

}  // namespace tessera
