#include "coordinator/picture_stream.h"

#include <algorithm>
#include <utility>

#include "coordinator/guarded.h"
#include "proto/terms.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/util/digest.h"

namespace tessera {
PictureStream::PictureStream(PictureStreams& streams, LastingCall call)
    : streams_(streams), call_(std::move(call)), watched_(streams.stall_watch.Watch(call_.context())) {}

void PictureStream::OnDone() {
  watched_->End();
  delete this;
}

void PictureStream::Refuse(const grpc::Status& status) {
  watched_->BeginWait();
  Finish(Shortened(status));
}

void PictureStream::Send(Result<std::string> bytes) {
  SendStored(std::move(bytes));
}

void PictureStream::Send(Result<StoredPicture> picture) {
  SendStored(std::move(picture));
}

template <typename Picture>
void PictureStream::SendStored(Result<Picture> picture) {
  if (!picture) {
    const Error& error = picture.error();
    return Refuse(error.kind == ErrorKind::kInterrupted ? TryAgain(error.message) : ToStatus(error));
  }
  const auto kept = GuardedResult([&] { return Store(std::move(*picture)); });
  if (!kept) return Refuse({grpc::StatusCode::RESOURCE_EXHAUSTED, kept.error().message});
  SendNext();
}

Result<void> PictureStream::Store(std::string bytes) {
  size_ = bytes.size();
  chunk_.set_size(size_);
  chunk_.set_digest(WriteDigest(Sha256(bytes)));
  if (size_ <= static_cast<uint64_t>(kChunkBytesMax)) {
    bytes_ = std::move(bytes);
    return {};
  }
  auto file = streams_.directory.KeepForSending(bytes);
  if (!file) return file.error();
  file_ = std::move(*file);
  return {};
}

Result<void> PictureStream::Store(StoredPicture picture) {
  size_ = picture.file.size();
  chunk_.set_size(size_);
  chunk_.set_digest(WriteDigest(picture.digest));
  file_ = std::move(picture.file);
  return {};
}

void PictureStream::SendNext() {
  const grpc::Status read = GuardedStatus([this] { return ReadNext(); });
  if (!read.ok()) return Refuse(read);
  watched_->BeginWait();
  StartWrite(&chunk_);
}

grpc::Status PictureStream::ReadNext() {
  if (const grpc::Status admitted = call_.Recheck(); !admitted.ok()) return admitted;
  std::string& data = *chunk_.mutable_data();
  if (!file_) {
    data = std::move(bytes_);
  } else {
    const uint64_t size = std::min(size_ - sent_, static_cast<uint64_t>(kChunkBytesMax));
    data.resize(size);
    if (const auto read = file_->Read(sent_, data); !read || data.size() != size)
      return {grpc::StatusCode::UNAVAILABLE, "the file of the picture cannot be read"};
  }
  sent_ += data.size();
  return grpc::Status::OK;
}

void PictureStream::OnWriteDone(bool ok) {
  watched_->EndWait();
  if (!ok) {
    Finish(grpc::Status::CANCELLED);
  } else if (sent_ == size_) {
    Finish(grpc::Status::OK);
  } else {
    // gRPC's threads never wait for the disk.
    streams_.threads.Post([this] {
      chunk_.Clear();
      SendNext();
    });
  }
}

}  // namespace tessera
