// Who connects, as far as the network shows: an IPv4 address, or the first 64 bits of an IPv6 address, since
// whoever has one such address usually has all of that network.
#pragma once

#include <sys/socket.h>

#include <array>
#include <compare>
#include <cstdint>
#include <string>

namespace tessera {

struct PeerNetwork {
  // An IPv6 address; an IPv4 address is mapped to one.
  std::array<uint8_t, 16> bytes{};
  auto operator<=>(const PeerNetwork&) const = default;
};

PeerNetwork NetworkOf(const sockaddr_storage& address);

// As in "10.0.0.5:4711" or "[2001:db8::1]:4711", for logs.
std::string PeerText(const sockaddr_storage& address);

// The other end of a connection; all zeros if it is closed.
sockaddr_storage PeerOf(int socket);

}  // namespace tessera
