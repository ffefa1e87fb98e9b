#include "coordinator/listener/header_limit.h"

#include <algorithm>
#include <string_view>

namespace tessera {
namespace {

constexpr std::string_view kPreface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
// Types of frames and the flag of the last one with headers of a request.
constexpr unsigned char kHeaders = 1, kContinuation = 9, kEndHeaders = 4;

}  // namespace

bool HeaderLimit::Take(std::span<const unsigned char> bytes) {
  while (!bytes.empty() && is_http2_ && !is_exceeded_) {
    size_t taken = std::min(bytes.size(), payload_left_);
    if (preface_bytes_ < kPreface.size()) {
      taken = TakePreface(bytes);
    } else if (payload_left_ > 0) {
      payload_left_ -= taken;
    } else {
      taken = TakeFrameHead(bytes);
    }
    bytes = bytes.subspan(taken);
  }
  return !is_exceeded_;
}

size_t HeaderLimit::TakePreface(std::span<const unsigned char> bytes) {
  is_http2_ = bytes.front() == static_cast<unsigned char>(kPreface[preface_bytes_]);
  ++preface_bytes_;
  return 1;
}

size_t HeaderLimit::TakeFrameHead(std::span<const unsigned char> bytes) {
  const size_t taken = std::min(bytes.size(), head_.size() - head_bytes_);
  std::copy_n(bytes.begin(), taken, head_.begin() + static_cast<std::ptrdiff_t>(head_bytes_));
  head_bytes_ += taken;
  if (head_bytes_ == head_.size()) {
    head_bytes_ = 0;
    CountFrame();
  }
  return taken;
}

// A frame without a payload costs something, too.
void HeaderLimit::CountFrame() {
  payload_left_ = size_t{head_[0]} << 16 | size_t{head_[1]} << 8 | size_t{head_[2]};
  const unsigned char type = head_[3], flags = head_[4];
  if (type != kHeaders && type != kContinuation) return;
  block_bytes_ += kFrameHeadBytes + payload_left_;
  is_exceeded_ = block_bytes_ > kHeaderBlockBytesMax;
  if ((flags & kEndHeaders) != 0) block_bytes_ = 0;
}

}  // namespace tessera
