// Bounds the headers of requests in what a client sends over HTTP/2 (RFC 9113). gRPC 1.51 bounds each frame
// of them, but collects any number of CONTINUATION frames for one request, and each byte of those can take 30
// bytes of memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// Frames with the headers of one request or the trailers of one, as they are transferred. gRPC refuses
// requests with more than 8 KiB, so these are enough for it to answer such a request.
constexpr size_t kHeaderBlockBytesMax = size_t{32} << 10;

// Of one connection. Not thread safe.
class HeaderLimit {
 public:
  // Takes the next bytes that the client has sent. Returns false, from then on, if the headers of a request
  // exceed the limit. Accepts everything from a client that does not begin as HTTP/2 does.
  bool Take(std::span<const unsigned char> bytes);

 private:
  static constexpr size_t kFrameHeadBytes = 9;

  size_t TakePreface(std::span<const unsigned char> bytes);
  size_t TakeFrameHead(std::span<const unsigned char> bytes);
  void CountFrame();

  bool is_http2_ = true, is_exceeded_ = false;
  size_t preface_bytes_ = 0;  // that have arrived
  std::array<unsigned char, kFrameHeadBytes> head_{};
  size_t head_bytes_ = 0;    // of head_ that have arrived
  size_t payload_left_ = 0;  // of the frame
  size_t block_bytes_ = 0;   // of the headers that are arriving
};

}  // namespace tessera
