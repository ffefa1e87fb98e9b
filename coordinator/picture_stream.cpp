#include "coordinator/picture_stream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "coordinator/guarded.h"
#include "proto/terms.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/util/digest.h"

namespace tessera {
namespace {

// A new file that has no name any more.
Result<int> TemporaryFile(const std::string& folder) {
  std::string path = folder + "/fetch-XXXXXX";
  const int file = ::mkostemp(path.data(), O_CLOEXEC);
  if (file < 0) return Failed(fmt::format("{}: cannot be created: {}", path, std::strerror(errno)));
  ::unlink(path.c_str());
  return file;
}

bool WriteAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t size = ::write(file, bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return false;
    bytes.remove_prefix(static_cast<size_t>(size));
  }
  return true;
}

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

PictureStream::~PictureStream() {
  if (file_ >= 0) ::close(file_);
}

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
  const auto kept = GuardedResult([&] { return Keep(std::move(*bytes)); });
  if (!kept) return Refuse({grpc::StatusCode::RESOURCE_EXHAUSTED, kept.error().message});
  SendNext();
}

Result<void> PictureStream::Keep(std::string bytes) {
  size_ = bytes.size();
  chunk_.set_size(size_);
  chunk_.set_digest(WriteDigest(Sha256(bytes)));
  if (size_ <= static_cast<uint64_t>(kChunkBytesMax)) {
    bytes_ = std::move(bytes);
    return {};
  }
  const auto file = TemporaryFile(streams_.folder);
  if (!file) return file.error();
  file_ = *file;
  if (!WriteAll(file_, bytes))
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
  if (file_ < 0) {
    data = std::move(bytes_);
  } else {
    data.resize(std::min(size_ - sent_, static_cast<uint64_t>(kChunkBytesMax)));
    if (!ReadAllAt(file_, sent_, data))
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
