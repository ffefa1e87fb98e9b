#include "coordinator/listener/peer_network.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

#include <cstring>

namespace tessera {
namespace {

sockaddr_storage Ipv4(const char* text, int port = 0) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_port = htons(static_cast<uint16_t>(port));
  EXPECT_EQ(::inet_pton(AF_INET, text, &name.sin_addr), 1);
  sockaddr_storage address{};
  std::memcpy(&address, &name, sizeof name);
  return address;
}

sockaddr_storage Ipv6(const char* text, int port = 0) {
  sockaddr_in6 name{};
  name.sin6_family = AF_INET6;
  name.sin6_port = htons(static_cast<uint16_t>(port));
  EXPECT_EQ(::inet_pton(AF_INET6, text, &name.sin6_addr), 1);
  sockaddr_storage address{};
  std::memcpy(&address, &name, sizeof name);
  return address;
}

TEST(PeerNetwork, IsAnIpv4AddressOrAnIpv6NetworkOf64Bits) {
  EXPECT_EQ(NetworkOf(Ipv4("10.0.0.1", 1)), NetworkOf(Ipv4("10.0.0.1", 2)));
  EXPECT_NE(NetworkOf(Ipv4("10.0.0.1")), NetworkOf(Ipv4("10.0.0.2")));
  EXPECT_EQ(NetworkOf(Ipv6("2001:db8:1:2::1")), NetworkOf(Ipv6("2001:db8:1:2:ffff::7")));
  EXPECT_NE(NetworkOf(Ipv6("2001:db8:1:2::1")), NetworkOf(Ipv6("2001:db8:1:3::1")));
}

// A socket for both versions of IP shows IPv4 addresses in this form.
TEST(PeerNetwork, AMappedIpv4AddressIsThatAddress) {
  EXPECT_EQ(NetworkOf(Ipv6("::ffff:10.0.0.1")), NetworkOf(Ipv4("10.0.0.1")));
  EXPECT_NE(NetworkOf(Ipv6("::ffff:10.0.0.1")), NetworkOf(Ipv6("::ffff:10.0.0.2")));
  EXPECT_EQ(PeerText(Ipv6("::ffff:10.0.0.1", 80)), "10.0.0.1:80");
}

TEST(PeerNetwork, IsWrittenAsUsual) {
  EXPECT_EQ(PeerText(Ipv4("10.0.0.1", 4711)), "10.0.0.1:4711");
  EXPECT_EQ(PeerText(Ipv6("2001:db8::1", 4711)), "[2001:db8::1]:4711");
}

}  // namespace
}  // namespace tessera
