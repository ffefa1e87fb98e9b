#include "coordinator/listener.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "coordinator/descriptors.h"
#include "proto/shell/rare_log.h"
#include "proto/shell/system.h"

namespace tessera {
namespace {

constexpr int kBacklog = 4096;  // the kernel lowers it to its own limit
// Unacknowledged data for this long ends a connection.
constexpr unsigned kUnacknowledgedMax_ms = 20'000;
// Between attempts to accept while there is no descriptor.
constexpr int kRetryInterval_ms = 100;

Error CannotListen(const Address& address) {
  return Failed(fmt::format("cannot listen on {}: the address is in use or does not belong to this machine",
                            address.Text()));
}

void SetOption(int socket, int level, int name, unsigned value) {
  ::setsockopt(socket, level, name, &value, sizeof value);
}

// A socket that listens on the address, or -1.
int ListenOn(const sockaddr* address, socklen_t size) {
  const int socket = ::socket(address->sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return -1;
  if (address->sa_family != AF_UNIX) {
    SetOption(socket, SOL_SOCKET, SO_REUSEADDR, 1);
    // Connections inherit these.
    SetOption(socket, IPPROTO_TCP, TCP_NODELAY, 1);
    SetOption(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnacknowledgedMax_ms);
  }
  if (address->sa_family == AF_INET6) SetOption(socket, IPPROTO_IPV6, IPV6_V6ONLY, 0);
  if (::bind(socket, address, size) == 0 && ::listen(socket, kBacklog) == 0) return socket;
  ::close(socket);
  return -1;
}

int ListenOnPath(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode)) ::unlink(path.c_str());
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  return ListenOn(reinterpret_cast<const sockaddr*>(&name), sizeof name);
}

int PortOf(int socket) {
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&name), &size) != 0) return 0;
  const bool is_ipv6 = name.ss_family == AF_INET6;
  return ntohs(is_ipv6 ? reinterpret_cast<const sockaddr_in6&>(name).sin6_port
                       : reinterpret_cast<const sockaddr_in&>(name).sin_port);
}

void SetPort(sockaddr* address, int port) {
  const in_port_t number = htons(static_cast<uint16_t>(port));
  if (address->sa_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6*>(address)->sin6_port = number;
  } else {
    reinterpret_cast<sockaddr_in*>(address)->sin_port = number;
  }
}

// Sockets on all addresses of the host, with one port. A wildcard means both versions of IP.
std::vector<int> ListenOnHost(const std::string& host, int& port) {
  std::vector<int> sockets;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  const std::string service = std::to_string(port);
  const std::vector<std::string> names =
      host == "0.0.0.0" ? std::vector<std::string>{"::", host} : std::vector<std::string>{host};
  for (const std::string& name : names) {
    addrinfo* found = nullptr;
    if (::getaddrinfo(name.c_str(), service.c_str(), &hints, &found) != 0) continue;
    for (addrinfo* each = found; each != nullptr; each = each->ai_next) {
      SetPort(each->ai_addr, port);
      const int socket = ListenOn(each->ai_addr, each->ai_addrlen);
      if (socket < 0) continue;
      sockets.push_back(socket);
      if (port == 0) port = PortOf(socket);
    }
    ::freeaddrinfo(found);
    if (!sockets.empty()) break;
  }
  return sockets;
}

}  // namespace

Result<std::unique_ptr<Listener>> Listener::Open(const std::vector<Address>& addresses) {
  std::unique_ptr<Listener> listener(new Listener);
  listener->stop_event_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (listener->stop_event_ < 0) return Failed(fmt::format("cannot listen: {}", std::strerror(errno)));
  for (const Address& address : addresses) {
    if (const auto bound = listener->Bind(address); !bound) return bound.error();
  }
  return listener;
}

Result<void> Listener::Bind(Address address) {
  if (address.kind == Address::Kind::kUnix) {
    // Binding would take the name away from another process.
    const int socket = CanConnect(address.path) ? -1 : ListenOnPath(address.path);
    if (socket < 0) return CannotListen(address);
    sockets_.push_back(socket);
  } else {
    const std::vector<int> sockets = ListenOnHost(address.host, address.port);
    if (sockets.empty()) return CannotListen(address);
    sockets_.insert(sockets_.end(), sockets.begin(), sockets.end());
  }
  addresses_.push_back(std::move(address));
  return {};
}

Listener::~Listener() {
  Stop();
  if (stop_event_ >= 0) ::close(stop_event_);
}

void Listener::Start(OnConnection on_connection) {
  thread_ = std::thread([this, on_connection = std::move(on_connection)] { Run(on_connection); });
}

void Listener::Stop() {
  ::eventfd_write(stop_event_, 1);
  if (thread_.joinable()) thread_.join();
  for (const int socket : sockets_) ::close(socket);
  if (sockets_.empty()) return;
  sockets_.clear();
  for (const Address& address : addresses_) {
    if (address.kind == Address::Kind::kUnix) ::unlink(address.path.c_str());
  }
}

void Listener::Run(const OnConnection& on_connection) {
  std::vector<pollfd> polled{{stop_event_, POLLIN, 0}};
  for (const int socket : sockets_) polled.push_back({socket, POLLIN, 0});
  while (true) {
    if (::poll(polled.data(), polled.size(), -1) < 0 && errno != EINTR) return;
    if (polled.front().revents != 0) return;
    for (const pollfd& each : polled) {
      if (each.revents != 0) AcceptAll(each.fd, on_connection);
    }
  }
}

void Listener::AcceptAll(int socket, const OnConnection& on_connection) {
  while (true) {
    const int connection = ::accept4(socket, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (connection >= ConnectionDescriptorsMax()) {
      ::close(connection);
      refused_.Warn("connections_refused", "reason=\"the descriptors for connections are used up\"");
    } else if (connection >= 0) {
      on_connection(connection);
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return;
    } else if (errno != EINTR && errno != ECONNABORTED && errno != EPROTO) {
      failed_.Warn("accept_failed", fmt::format("reason=\"{}\"", std::strerror(errno)));
      pollfd stop{stop_event_, POLLIN, 0};
      ::poll(&stop, 1, kRetryInterval_ms);
      return;
    }
  }
}

}  // namespace tessera
