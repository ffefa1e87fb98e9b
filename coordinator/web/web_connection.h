// One connection of the web pages: a request, its answer, and the end.
#pragma once

#include <poll.h>

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/web/http_response.h"
#include "coordinator/web/web_site.h"
#include "coordinator/web/web_stream.h"

namespace tessera {

// Used by the thread of the server alone.
class WebConnection {
 public:
  using Clock = std::chrono::steady_clock;
  enum class State {
    kHandshake,
    kReading,
    kReceiving,  // a body that is taken in pieces
    kAwaiting,   // another thread makes the answer, or takes a piece of the body
    kWriting,    // an answer whose length is known
    kStreaming,  // an answer that is made while it is sent
    kClosing,
    kClosed
  };

  WebConnection(int socket, const TlsServer* tls);

  int socket() const { return stream_.socket(); }
  State state() const { return state_; }
  short awaited() const { return awaited_; }
  bool IsWaitingForRequest() const { return state_ == State::kHandshake || state_ == State::kReading; }
  // Whether it stays open for as long as the peer likes.
  bool IsStream() const { return state_ == State::kStreaming; }
  // Whether it sends a body that is taken in pieces.
  bool IsUpload() const { return sink_ != nullptr; }
  const std::string& stream_owner() const { return stream_owner_; }
  bool HasEnded(Clock::time_point now) const { return state_ == State::kClosed || now > deadline_; }
  void Close() { state_ = State::kClosed; }

  // Returns whether the handshake was completed in this call.
  bool Handshake();
  std::string HandshakeFailure() const;
  // Returns whether bytes of the request were received.
  bool Read();
  const std::string& received() const { return in_; }

  // Takes the body, of `body_size` bytes: what was received after the head of `head_size` bytes, and the
  // rest. `notify` as for Send, after each piece.
  void Receive(HttpResponse response, size_t head_size, uint64_t body_size, std::function<void()> notify);
  // The last piece was taken.
  void ReceiveMore();

  // Sends an answer, or waits for it: `notify` is then called, from any thread, when TakeLater returns it.
  void Send(HttpResponse response, const std::function<void()>& notify);
  std::optional<HttpResponse> TakeLater() { return later_ != nullptr ? later_->Take() : std::nullopt; }
  // To a HEAD: the answers are sent without their bodies.
  void OmitBody() { has_body_ = false; }
  // Goes on: the socket is ready, or, with `is_ready` false, time has passed.
  void Resume(bool is_ready);

  WebPeer peer;

 private:
  using Step = WebStream::Step;
  void ReadBody();
  void HandOver();
  void Write();
  void Pump();
  bool WriteParts();
  void EndWriting();
  void Drop();
  bool Continue(Step step);

  WebStream stream_;
  State state_ = State::kHandshake;
  short awaited_ = POLLIN;
  Clock::time_point deadline_;
  std::string in_;
  std::deque<BodyStream::Part> parts_;  // to be sent; each may be shared by many connections
  size_t sent_ = 0;                     // of the first of them
  std::shared_ptr<BodyStream> body_;
  std::shared_ptr<BodySink> sink_;
  uint64_t body_left_ = 0;  // bytes of the body that were not handed to the sink
  std::function<void()> notify_;
  std::shared_ptr<LaterAnswer> later_;
  std::string stream_owner_;
  bool has_body_ = true;
  size_t dropped_ = 0;
};

}  // namespace tessera
