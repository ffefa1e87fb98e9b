#include "proto/wire/probe_socket.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>

namespace tessera {

bool Interruption::Request() {
  const std::lock_guard lock(mutex_);
  is_requested_ = true;
  // Whoever waits for the socket continues and finds that it is closed.
  if (socket_ >= 0) ::shutdown(socket_, SHUT_RDWR);
  return is_resolving_;
}

bool Interruption::SetResolving(bool is_resolving) {
  const std::lock_guard lock(mutex_);
  is_resolving_ = is_resolving;
  return !is_requested_;
}

void Interruption::Start(int socket) {
  const std::lock_guard lock(mutex_);
  socket_ = socket;
}

void Interruption::End() {
  const std::lock_guard lock(mutex_);
  socket_ = -1;
}

bool Interruption::IsRequested() {
  const std::lock_guard lock(mutex_);
  return is_requested_;
}

ResolvedHost Resolve(const std::string& host, int port, Interruption& interruption) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (!interruption.EnterResolving()) return {EAI_AGAIN};
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  ResolvedHost resolved{error, {found, &::freeaddrinfo}};
  if (!interruption.LeaveResolving()) return {EAI_AGAIN};
  return resolved;
}

ProbeSocket::ProbeSocket(int family, Interruption& interruption)
    : interruption_(interruption), fd_(::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  interruption_.Start(fd_);
}

ProbeSocket::~ProbeSocket() {
  interruption_.End();
  if (fd_ >= 0) ::close(fd_);
}

int ProbeSocket::Connect(const sockaddr* address, socklen_t size, TimePoint deadline) const {
  if (fd_ < 0) return errno;
  const int failed = ::connect(fd_, address, size) == 0 ? 0 : errno;
  // A request before this moment found no connection to end.
  if (interruption_.IsRequested()) return ECONNABORTED;
  // EAGAIN: the queue of a Unix socket is full.
  if (failed == EAGAIN) return ETIMEDOUT;
  if (failed != EINPROGRESS) return failed;
  if (!Await(POLLOUT, deadline)) return ETIMEDOUT;
  int error = 0;
  socklen_t error_size = sizeof error;
  return ::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &error_size) == 0 ? error : errno;
}

bool ProbeSocket::Await(short events, TimePoint deadline) const {
  pollfd event{fd_, events, 0};
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    const int count = ::poll(&event, 1, left.count() > 0 ? static_cast<int>(left.count()) : 0);
    if (count > 0) return true;
    if (count == 0 || errno != EINTR) return false;
  }
}

}  // namespace tessera
