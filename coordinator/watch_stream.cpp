#include "coordinator/watch_stream.h"

#include "proto/wire/channel.h"
#include "proto/wire/convert.h"

namespace tessera {

WatchStream::WatchStream() : link_(std::make_shared<Link>()) {
  link_->stream_ = this;
}

bool WatchStream::Link::Offer(const JobStatus* status, bool last) {
  if (status == nullptr) {
    Finish(CoordinatorEnds());
    return false;
  }
  const std::lock_guard lock(mutex_);
  if (stream_ == nullptr) return false;
  next_ = *status;
  last_ = last;
  if (!sending_) SendNext();
  return true;
}

void WatchStream::Link::Finish(const grpc::Status& status) {
  const std::lock_guard lock(mutex_);
  if (stream_ == nullptr) return;
  std::exchange(stream_, nullptr)->Finish(status);
}

bool WatchStream::Link::IsOpen() {
  const std::lock_guard lock(mutex_);
  return stream_ != nullptr;
}

void WatchStream::Link::SendNext() {
  message_.Clear();
  Write(*next_, message_);
  next_.reset();
  sending_ = true;
  stream_->StartWrite(&message_);
}

void WatchStream::OnWriteDone(bool ok) {
  const auto link = link_;  // outlives this stream, which Finish may end
  const std::lock_guard lock(link->mutex_);
  link->sending_ = false;
  if (link->stream_ == nullptr) return;
  if (ok && link->next_) {
    link->SendNext();
  } else if (!ok || link->last_) {
    link->stream_ = nullptr;
    Finish(ok ? grpc::Status::OK : grpc::Status::CANCELLED);
  }
}

void WatchStream::OnCancel() {
  const auto link = link_;
  link->Finish(grpc::Status::CANCELLED);
}

}  // namespace tessera
