#include "coordinator/web/web_connection.h"

#include <algorithm>
#include <utility>

namespace tessera {
namespace {

using std::chrono::seconds;

constexpr seconds kRequestPatience{5};  // for the handshake and a whole request
constexpr seconds kMakePatience{120};   // for an answer that another thread makes
// For a piece of a body: 4 KB/s. Whoever sends less keeps others from sending.
constexpr seconds kPiecePatience{30};
constexpr seconds kAnswerPatience{10};  // for the peer to take an answer, or anything of a stream or download
constexpr seconds kClosePatience{1};    // for the peer to close after it
constexpr size_t kDroppedBytesMax = 1 << 20;

}  // namespace

WebConnection::WebConnection(int socket, const TlsServer* tls)
    : stream_(socket, tls), deadline_(Clock::now() + kRequestPatience) {}

bool WebConnection::Handshake() {
  if (!Continue(stream_.Handshake())) return false;
  peer.certificate = stream_.PeerCertificate();
  state_ = State::kReading;
  awaited_ = POLLIN;
  return true;
}

std::string WebConnection::HandshakeFailure() const {
  return state_ == State::kClosed ? stream_.reason() : "";
}

bool WebConnection::Read() {
  char bytes[TlsStream::kRecordBytesMax];
  size_t size = 0;
  if (!Continue(stream_.Read(bytes, sizeof bytes, size))) return false;
  in_.append(bytes, size);
  return true;
}

void WebConnection::Receive(HttpResponse response, size_t head_size, uint64_t body_size,
                            std::function<void()> notify) {
  sink_ = std::move(response.sink);
  stream_owner_ = std::move(response.stream_owner);
  notify_ = std::move(notify);
  in_.erase(0, head_size);
  body_left_ = body_size;
  ReceiveMore();
}

void WebConnection::ReceiveMore() {
  state_ = State::kReceiving;
  awaited_ = POLLIN;
  deadline_ = Clock::now() + kPiecePatience;
  HandOver();
}

// Other connections are served between pieces.
void WebConnection::ReadBody() {
  const uint64_t wanted = std::min<uint64_t>(body_left_, kBodyPieceBytes);
  while (in_.size() < wanted) {
    if (!Read()) return;
  }
  HandOver();
}

// Nothing is read while the sink is busy, so that a peer sends no faster than its bytes are stored.
void WebConnection::HandOver() {
  if (in_.size() < std::min<uint64_t>(body_left_, kBodyPieceBytes)) return;
  if (in_.size() > body_left_) in_.resize(static_cast<size_t>(body_left_));
  body_left_ -= in_.size();
  state_ = State::kAwaiting;
  awaited_ = 0;
  deadline_ = Clock::now() + kMakePatience;
  later_ = std::make_shared<LaterAnswer>();
  later_->OnGiven(notify_);
  sink_->Take(std::exchange(in_, {}), body_left_ == 0, later_);
}

void WebConnection::Send(HttpResponse response, const std::function<void()>& notify) {
  in_.clear();
  later_.reset();
  sink_.reset();
  if (response.later != nullptr) {
    later_ = std::move(response.later);
    state_ = State::kAwaiting;
    awaited_ = POLLIN;
    deadline_ = Clock::now() + kMakePatience;
    return later_->OnGiven(notify);
  }
  parts_.push_back(std::make_shared<const std::string>(response.Head()));
  if (has_body_ && response.body != nullptr) parts_.push_back(response.body);
  if (has_body_) body_ = std::move(response.stream);
  stream_owner_ = std::move(response.stream_owner);
  state_ = body_ != nullptr ? State::kStreaming : State::kWriting;
  deadline_ = Clock::now() + kAnswerPatience;
  Resume(true);
}

void WebConnection::Resume(bool is_ready) {
  switch (state_) {
    case State::kReceiving: return is_ready ? ReadBody() : void();
    case State::kAwaiting:
      // Nothing is awaited from a peer whose body is being stored, so what there is is its end.
      if (is_ready && sink_ != nullptr) return Close();
      return is_ready ? Drop() : void();
    case State::kClosing: return is_ready ? Drop() : void();
    case State::kWriting: return is_ready ? Write() : void();
    case State::kStreaming:
      if (is_ready && awaited_ == POLLIN) Drop();
      return state_ == State::kStreaming && (is_ready || awaited_ == POLLIN) ? Pump() : void();
    default: return;
  }
}

// Whether everything that there is was sent.
bool WebConnection::WriteParts() {
  while (!parts_.empty()) {
    const std::string_view part = std::string_view(*parts_.front()).substr(sent_);
    size_t size = 0;
    if (!part.empty() && !Continue(stream_.Write(part, size))) return false;
    if (size > 0) deadline_ = Clock::now() + kAnswerPatience;
    sent_ += size;
    if (size < part.size()) continue;
    parts_.pop_front();
    sent_ = 0;
  }
  return true;
}

void WebConnection::Write() {
  if (WriteParts()) EndWriting();
}

// Closing while unread bytes are there would take the answer away from the peer.
void WebConnection::EndWriting() {
  body_.reset();
  stream_.EndWriting();
  state_ = State::kClosing;
  awaited_ = POLLIN;
  deadline_ = Clock::now() + kClosePatience;
}

// At most one round of parts in a call: other connections are served in between.
void WebConnection::Pump() {
  if (!WriteParts()) return;
  std::vector<BodyStream::Part> parts;
  const BodyStream::Next next = body_->Take(parts);
  parts_.assign(parts.begin(), parts.end());
  if (next == BodyStream::Next::kEnd) {
    body_.reset();
    state_ = State::kWriting;
  }
  // Nothing is late while there is nothing to send.
  deadline_ = Clock::now() + kAnswerPatience;
  awaited_ = next == BodyStream::Next::kLater ? POLLIN : POLLOUT;
}

// What follows a request is dropped, up to a limit.
void WebConnection::Drop() {
  bool is_open = true;
  dropped_ += stream_.Drop(is_open);
  if (!is_open || dropped_ > kDroppedBytesMax) state_ = State::kClosed;
}

// Whether a step is done. Otherwise it is repeated later, or the connection is closed.
bool WebConnection::Continue(Step step) {
  if (step == Step::kFailed) state_ = State::kClosed;
  if (step == Step::kAwaitRead) awaited_ = POLLIN;
  if (step == Step::kAwaitWrite) awaited_ = POLLOUT;
  return step == Step::kDone;
}

}  // namespace tessera
