#include "coordinator/listener/listener.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "coordinator/listener/descriptors.h"
#include "coordinator/listener/listen_sockets.h"
#include "proto/shell/system.h"
#include "proto/wire/local_socket.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Between attempts to accept while there is no descriptor.
constexpr int kRetryInterval_ms = 100;
// Before it looks at the others again, however many come to one socket.
constexpr int kAcceptedMax = 256;

Error CannotListen(const Address& address) {
  return Failed(fmt::format("cannot listen on {}: the address is in use or does not belong to this machine",
                            address.Text()));
}

}  // namespace

Result<std::unique_ptr<Listener>> Listener::Open(const std::vector<Address>& addresses) {
  std::unique_ptr<Listener> listener(new Listener);
  listener->stop_event_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (listener->stop_event_ < 0) return Failed(fmt::format("cannot listen: {}", std::strerror(errno)));
  for (const Address& address : addresses) {
    Address bound = address;
    if (const auto done = listener->Bind(bound); !done) return done.error();
    listener->addresses_.push_back(std::move(bound));
  }
  return listener;
}

Result<void> Listener::OpenLocalSockets(const std::string& folder) {
  for (const Address& address : addresses_) {
    auto local = LocalSocketOf(address, folder);
    if (!local) continue;
    if (auto prepared = PrepareLocalSocketFolder(folder); !prepared) return prepared;
    if (auto bound = Bind(*local); !bound) return bound;
    local_sockets_.push_back(std::move(*local));
  }
  return {};
}

Result<void> Listener::Bind(Address& address) {
  if (address.kind == Address::Kind::kUnix) {
    // Binding would take the name away from another process.
    const int socket = CanConnect(address.path) ? -1 : ListenOnPath(address.path);
    if (socket < 0) return CannotListen(address);
    sockets_.push_back({socket, address.kind});
  } else {
    const std::vector<int> sockets = ListenOnHost(address.host, address.port);
    if (sockets.empty()) return CannotListen(address);
    for (const int socket : sockets) sockets_.push_back({socket, address.kind});
  }
  return {};
}

Listener::~Listener() {
  Stop();
  if (stop_event_ >= 0) ::close(stop_event_);
}

void Listener::Start(std::shared_ptr<PendingConnections> pending, OnConnection on_connection) {
  pending_ = std::move(pending);
  thread_ = std::thread([this, on_connection = std::move(on_connection)] { Run(on_connection); });
}

void Listener::Stop() {
  ::eventfd_write(stop_event_, 1);
  if (thread_.joinable()) thread_.join();
  if (sockets_.empty()) return;
  // Before the ports are free, or the sockets of the next process could be removed.
  for (const auto* addresses : {&addresses_, &local_sockets_}) {
    for (const Address& address : *addresses) {
      if (address.kind == Address::Kind::kUnix) ::unlink(address.path.c_str());
    }
  }
  for (const Socket& socket : sockets_) ::close(socket.fd);
  sockets_.clear();
}

void Listener::Run(const OnConnection& on_connection) {
  std::vector<pollfd> polled{{stop_event_, POLLIN, 0}};
  for (const Socket& socket : sockets_) polled.push_back({socket.fd, POLLIN, 0});
  polled.push_back({pending_ != nullptr ? pending_->events() : -1, POLLIN, 0});
  while (true) {
    if (::poll(polled.data(), polled.size(), -1) < 0 && errno != EINTR) return;
    if (polled.front().revents != 0) return;
    if (polled.back().revents != 0) pending_->RemoveClosed();
    for (size_t i = 0; i < sockets_.size(); ++i) {
      if (polled[i + 1].revents != 0) AcceptAll(sockets_[i], on_connection);
    }
  }
}

bool Listener::MayPass(int connection, Address::Kind kind, const sockaddr_storage& peer) {
  if (connection >= ConnectionDescriptorsMax()) {
    refused_.Warn("connections_refused", "reason=\"the descriptors for connections are used up\"");
  } else if (kind == Address::Kind::kUnix || pending_ == nullptr ||
             pending_->Add(connection, peer, std::chrono::steady_clock::now())) {
    return true;
  } else {
    crowded_.Warn("connections_refused",
                  fmt::format("peer={} reason=\"too many handshakes from there\"", LogText(PeerText(peer))));
  }
  ::close(connection);
  return false;
}

void Listener::AcceptAll(const Socket& socket, const OnConnection& on_connection) {
  for (int count = 0; count < kAcceptedMax; ++count) {
    sockaddr_storage peer{};
    socklen_t size = sizeof peer;
    const int connection =
        ::accept4(socket.fd, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (connection >= 0) {
      if (MayPass(connection, socket.kind, peer)) on_connection(connection, socket.kind);
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return;
    } else if (IsLastingAcceptFailure(errno)) {
      failed_.Warn("accept_failed", fmt::format("reason={}", LogText(std::strerror(errno))));
      pollfd stop{stop_event_, POLLIN, 0};
      ::poll(&stop, 1, kRetryInterval_ms);
      return;
    }
  }
}

}  // namespace tessera
