#include "coordinator/picture_stream.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "coordinator/guarded.h"
#include "proto/terms.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/util/digest.h"

namespace tessera {
namespace {

bool ReadAllAt(int file, uint64_t offset, std::string& bytes) {
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t size =
        ::pread(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return false;
    done += static_cast<size_t>(size);
  }
  return true;
}

}  // namespace

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
  if (!bytes) return Refuse(ToStatus(bytes.error()));
  const auto kept = GuardedResult([&] { return Store(std::move(*bytes)); });
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
  auto file = OpenNamelessFile(streams_.folder);
  if (!file) return file.error();
  file_ = std::move(*file);
  if (!WriteAll(file_.number(), bytes))
    return Failed(fmt::format("no room for a copy of the picture: {}", std::strerror(errno)));
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
    data.resize(std::min(size_ - sent_, static_cast<uint64_t>(kChunkBytesMax)));
    if (!ReadAllAt(file_.number(), sent_, data))
      return {grpc::StatusCode::UNAVAILABLE, "the copy of the picture cannot be read"};
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
