#include "coordinator/web/web_stream.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace tessera {
namespace {

WebStream::Step StepAfter(ssize_t result, WebStream::Step wait) {
  if (result > 0) return WebStream::Step::kDone;
  return result < 0 && (errno == EAGAIN || errno == EINTR) ? wait : WebStream::Step::kFailed;
}

size_t SizeOf(ssize_t result) {
  return result > 0 ? static_cast<size_t>(result) : 0;
}

}  // namespace

WebStream::WebStream(int socket, const TlsServer* tls) : socket_(socket) {
  if (tls != nullptr) tls_.emplace(*tls, socket);
}

WebStream::~WebStream() {
  ::close(socket_);
}

WebStream::Step WebStream::Handshake() {
  return tls_ ? tls_->Handshake() : Step::kDone;
}

WebStream::Step WebStream::Read(char* bytes, size_t size, size_t& received) {
  if (tls_) return tls_->Read(bytes, size, received);
  const ssize_t result = ::recv(socket_, bytes, size, 0);
  received = SizeOf(result);
  return StepAfter(result, Step::kAwaitRead);
}

WebStream::Step WebStream::Write(std::string_view bytes, size_t& sent) {
  if (tls_) return tls_->Write(bytes, sent);
  const ssize_t result = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  sent = SizeOf(result);
  return StepAfter(result, Step::kAwaitWrite);
}

void WebStream::EndWriting() {
  if (tls_) tls_->Close();
  ::shutdown(socket_, SHUT_WR);
}

size_t WebStream::Drop(bool& is_open) {
  char bytes[4096];
  const ssize_t result = ::recv(socket_, bytes, sizeof bytes, 0);
  is_open = StepAfter(result, Step::kAwaitRead) != Step::kFailed;
  return SizeOf(result);
}

std::optional<Certificate> WebStream::PeerCertificate() const {
  return tls_ ? tls_->PeerCertificate() : std::nullopt;
}

std::string WebStream::reason() const {
  return tls_ ? tls_->reason() : "";
}

}  // namespace tessera
