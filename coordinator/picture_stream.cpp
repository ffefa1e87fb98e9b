#include "coordinator/picture_stream.h"

#include <algorithm>

#include "proto/terms.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/digest.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr uint64_t kPictureBytesMax = uint64_t{32} << 30;  // 65536 x 65536 pixels hardly compress to more

}  // namespace

void PictureStream::SendFile(const std::string& path) {
  auto bytes = ReadFile(path, kPictureBytesMax);
  if (!bytes) {
    Finish({grpc::StatusCode::FAILED_PRECONDITION, bytes.error().message});
    return;
  }
  Send(std::move(*bytes));
}

void PictureStream::SendPicture(const FinishedPicture& picture) {
  auto bytes = EncodeExr(picture.spec->frames[picture.frame].spec, picture.snapshot.Picture());
  if (!bytes) {
    Finish(ToStatus(bytes.error()));
    return;
  }
  Send(std::move(*bytes));
}

void PictureStream::Send(std::string bytes) {
  bytes_ = std::move(bytes);
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
