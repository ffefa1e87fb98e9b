#include "coordinator/watch_stream.h"

#include "wire/convert.h"

namespace tessera {

WatchStream::WatchStream() : link_(std::make_shared<Link>()) {
  link_->stream_ = this;
}

bool WatchStream::Link::Offer(const JobStatus* status, bool last) {
  if (status == nullptr) {
    Finish({grpc::StatusCode::UNAVAILABLE, "the coordinator ends"});
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

void WatchStream::Link::SendNext() {
  message_.Clear();
  Write(*next_, message_);
  next_.reset();
  sending_ = true;
  stream_->StartWrite(&message_);
}

void WatchStream::OnWriteDone(bool ok) {
  const std::lock_guard lock(link_->mutex_);
  link_->sending_ = false;
  if (link_->stream_ == nullptr) return;
  if (ok && link_->next_) {
    link_->SendNext();
  } else if (!ok || link_->last_) {
    link_->stream_ = nullptr;
    Finish(ok ? grpc::Status::OK : grpc::Status::CANCELLED);
  }
}

void WatchStream::OnCancel() {
  link_->Finish(grpc::Status::CANCELLED);
}

}  // namespace tessera
