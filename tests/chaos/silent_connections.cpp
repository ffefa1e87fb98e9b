#include "tests/chaos/silent_connections.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <string_view>

namespace tessera {
namespace {

constexpr std::string_view kUnix = "unix:";

// A connection, or -1.
int Connect(const std::string& address) {
  sockaddr_in tcp{};
  sockaddr_un local{};
  const bool is_local = address.starts_with(kUnix);
  if (is_local) {
    local.sun_family = AF_UNIX;
    std::strncpy(local.sun_path, address.c_str() + kUnix.size(), sizeof local.sun_path - 1);
  } else {
    tcp.sin_family = AF_INET;
    tcp.sin_port = htons(static_cast<uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
    tcp.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  const int socket = ::socket(is_local ? AF_UNIX : AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto* name =
      is_local ? reinterpret_cast<const sockaddr*>(&local) : reinterpret_cast<const sockaddr*>(&tcp);
  const socklen_t size = is_local ? sizeof local : sizeof tcp;
  if (socket >= 0 && ::connect(socket, name, size) != 0 && errno != EINPROGRESS) {
    ::close(socket);
    return -1;
  }
  return socket;
}

}  // namespace

void SilentConnections::Open(const std::string& address, int count, Clock::duration duration) {
  End();
  until_ = Clock::now() + duration;
  for (int i = 0; i < count; ++i) {
    const int socket = Connect(address);
    if (socket < 0) return;
    sockets_.push_back(socket);
  }
}

void SilentConnections::Tick() {
  if (is_open() && Clock::now() >= until_) End();
}

void SilentConnections::End() {
  for (const int socket : sockets_) ::close(socket);
  sockets_.clear();
}

}  // namespace tessera
