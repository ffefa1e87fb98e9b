#include "coordinator/listener/peer_network.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

// All IPv6 addresses with the same first bytes are one network.
constexpr std::ptrdiff_t kNetworkBytes = 8;

in6_addr AsIpv6(const sockaddr_storage& address) {
  in6_addr result{};
  if (address.ss_family == AF_INET6) {
    sockaddr_in6 ipv6{};
    std::memcpy(&ipv6, &address, sizeof ipv6);
    return ipv6.sin6_addr;
  }
  if (address.ss_family == AF_INET) {
    sockaddr_in ipv4{};
    std::memcpy(&ipv4, &address, sizeof ipv4);
    result.s6_addr[10] = result.s6_addr[11] = 0xff;
    std::memcpy(&result.s6_addr[12], &ipv4.sin_addr, sizeof ipv4.sin_addr);
  }
  return result;
}

int PortOf(const sockaddr_storage& address) {
  if (address.ss_family != AF_INET && address.ss_family != AF_INET6) return 0;
  sockaddr_in ipv4{};  // both kinds begin with family and port
  std::memcpy(&ipv4, &address, sizeof ipv4);
  return ntohs(ipv4.sin_port);
}

}  // namespace

PeerNetwork NetworkOf(const sockaddr_storage& address) {
  const in6_addr ipv6 = AsIpv6(address);
  PeerNetwork network;
  std::ranges::copy(ipv6.s6_addr, network.bytes.begin());
  if (!IN6_IS_ADDR_V4MAPPED(&ipv6)) std::fill(network.bytes.begin() + kNetworkBytes, network.bytes.end(), 0);
  return network;
}

std::string PeerText(const sockaddr_storage& address) {
  const in6_addr ipv6 = AsIpv6(address);
  const bool is_ipv4 = IN6_IS_ADDR_V4MAPPED(&ipv6);
  char text[INET6_ADDRSTRLEN] = "";
  ::inet_ntop(is_ipv4 ? AF_INET : AF_INET6, is_ipv4 ? &ipv6.s6_addr[12] : &ipv6.s6_addr[0], text,
              sizeof text);
  return is_ipv4 ? fmt::format("{}:{}", text, PortOf(address))
                 : fmt::format("[{}]:{}", text, PortOf(address));
}

sockaddr_storage PeerOf(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return {};
  return address;
}

}  // namespace tessera
