#include "coordinator/listener/listen_sockets.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace tessera {
namespace {

constexpr mode_t kSocketMode = 0600;
constexpr int kBacklog = 4096;  // the kernel lowers it to its own limit
// Unacknowledged data for this long ends a connection.
constexpr unsigned kUnacknowledgedMax_ms = 20'000;

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
  const auto make_private = [address] {
    return address->sa_family != AF_UNIX ||
           ::chmod(reinterpret_cast<const sockaddr_un*>(address)->sun_path, kSocketMode) == 0;
  };
  // Nobody can connect before it listens.
  if (::bind(socket, address, size) == 0 && make_private() && ::listen(socket, kBacklog) == 0) return socket;
  ::close(socket);
  return -1;
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

}  // namespace

int ListenOnPath(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode)) ::unlink(path.c_str());
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  return ListenOn(reinterpret_cast<const sockaddr*>(&name), sizeof name);
}

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

bool IsLastingAcceptFailure(int error) {
  switch (error) {
    case EAGAIN:        // nobody waits
    case EINTR:         // a signal
    case ECONNABORTED:  // the peer has gone
    case EPROTO: return false;
    default: return true;
  }
}

}  // namespace tessera
