#include "coordinator/picture_stream.h"

#include <algorithm>

#include "proto/terms.h"
#include "proto/wire/convert.h"
#include "renderer/util/digest.h"

namespace tessera {

void PictureStream::Send(Result<std::string> bytes) {
  if (!bytes) {
    Finish({grpc::StatusCode::FAILED_PRECONDITION, bytes.error().message});
    return;
  }
  bytes_ = std::move(*bytes);
  chunk_.set_size(bytes_.size());
  chunk_.set_digest(WriteDigest(Sha256(bytes_)));
  SendNext();
}

void PictureStream::SendNext() {
  const size_t size = std::min(bytes_.size() - sent_, static_cast<size_t>(kChunkBytesMax));
  chunk_.set_data(bytes_.data() + sent_, size);
  sent_ += size;
  StartWrite(&chunk_);
}

void PictureStream::OnWriteDone(bool ok) {
  if (!ok) {
    Finish(grpc::Status::CANCELLED);
  } else if (sent_ == bytes_.size()) {
    Finish(grpc::Status::OK);
  } else {
    chunk_.Clear();
    SendNext();
  }
}

}  // namespace tessera
