#include "coordinator/listener/pending_connections.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "coordinator/listener/descriptors.h"

namespace tessera {
namespace {

using std::chrono::seconds;

constexpr PendingConnections::TimePoint kNow{std::chrono::hours(1)};

sockaddr_storage AddressAt(uint32_t address, int port) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = htonl(address);
  name.sin_port = htons(static_cast<uint16_t>(port));
  sockaddr_storage storage{};
  std::memcpy(&storage, &name, sizeof name);
  return storage;
}

constexpr uint32_t kHonest = 0x0a000001, kCrowded = 0x0a000002;

// A connection as gRPC has one, and its other end.
class SocketPair {
 public:
  SocketPair() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_), 0); }
  ~SocketPair() {
    for (const int end : ends_) ::close(end);
  }
  SocketPair(const SocketPair&) = delete;
  SocketPair& operator=(const SocketPair&) = delete;
  int ours() const { return ends_[0]; }
  bool IsOpen() const {
    pollfd polled{ends_[1], POLLIN | POLLRDHUP, 0};
    ::poll(&polled, 1, 0);
    return (polled.revents & (POLLRDHUP | POLLHUP)) == 0;
  }
  // As gRPC closes it.
  void Shutdown() { ::shutdown(ends_[0], SHUT_RDWR); }

 private:
  int ends_[2] = {-1, -1};
};

class Pending : public testing::Test {
 protected:
  Pending() { RaiseDescriptorLimit(); }
  bool Add(const SocketPair& pair, uint32_t address) {
    return pending_.Add(pair.ours(), AddressAt(address, ++port_), kNow);
  }
  std::string LastPeer() const { return "ipv4:10.0.0.1:" + std::to_string(port_); }

  PendingConnections pending_;
  int port_ = 1000;
};

TEST_F(Pending, ANetworkThatReachesItsBoundLosesItsOwnConnections) {
  SocketPair honest;
  EXPECT_TRUE(Add(honest, kHonest));
  std::vector<SocketPair> crowd(kPendingPerNetworkMax + 50);
  for (const SocketPair& each : crowd) EXPECT_TRUE(Add(each, kCrowded));
  EXPECT_EQ(pending_.size(), 1 + kPendingPerNetworkMax);
  EXPECT_TRUE(honest.IsOpen());
  EXPECT_EQ(std::ranges::count_if(crowd, &SocketPair::IsOpen),
            static_cast<std::ptrdiff_t>(kPendingPerNetworkMax));
  EXPECT_TRUE(crowd.back().IsOpen()) << "there is always a place for the next";
}

TEST_F(Pending, BeyondTheBoundOfAllTheNetworkWithTheMostGivesWay) {
  std::vector<SocketPair> crowd(40);
  for (const SocketPair& each : crowd) EXPECT_TRUE(Add(each, kCrowded));
  SocketPair shared;  // only counted
  const size_t others = PendingConnections::Max() - 20;
  for (uint32_t i = 0; i < others; ++i) EXPECT_TRUE(Add(shared, 0x0b000000 + i));
  EXPECT_EQ(pending_.size(), PendingConnections::Max());
  EXPECT_EQ(std::ranges::count_if(crowd, &SocketPair::IsOpen), 20);
  EXPECT_TRUE(shared.IsOpen());
}

TEST_F(Pending, ProcessesWithFewDescriptorsKeepMostOfThemForMembers) {
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &limit), 0);
  const rlimit small{512, limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &small), 0);
  EXPECT_LE(PendingConnections::Max(), 512 / kPendingShare);
  EXPECT_GT(PendingConnections::Max(), 32u);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
}

TEST_F(Pending, PeersThatIdentifyThemselvesCountNoLonger) {
  for (int i = 0; i < 1000; ++i) {
    SocketPair pair;
    ASSERT_TRUE(Add(pair, kHonest)) << "handshakes of members are given back";
    pending_.Identified(LastPeer());
    EXPECT_EQ(pending_.size(), 0u);
    EXPECT_TRUE(pair.IsOpen());
  }
  pending_.Identified("ipv4:10.9.9.9:1");
  pending_.Identified("unix:");
}

TEST_F(Pending, ConnectionsThatAreClosedAreForgotten) {
  SocketPair first, second;
  EXPECT_TRUE(Add(first, kHonest));
  EXPECT_TRUE(Add(second, kHonest));
  pending_.RemoveClosed();
  EXPECT_EQ(pending_.size(), 2u);
  first.Shutdown();
  pollfd polled{pending_.events(), POLLIN, 0};
  EXPECT_EQ(::poll(&polled, 1, 0), 1);
  pending_.RemoveClosed();
  EXPECT_EQ(pending_.size(), 1u);
  EXPECT_EQ(::poll(&polled, 1, 0), 0);
  EXPECT_TRUE(second.IsOpen());
}

// What is known of an identified connection goes with it, though the connection itself stays open.
TEST_F(Pending, TheEndOfAnIdentifiedConnectionIsNoEvent) {
  SocketPair pair;
  EXPECT_TRUE(Add(pair, kHonest));
  pending_.Identified(LastPeer());
  pair.Shutdown();
  pollfd polled{pending_.events(), POLLIN, 0};
  EXPECT_EQ(::poll(&polled, 1, 0), 0);
}

TEST_F(Pending, ANetworkThatOnlyMakesHandshakesIsSlowedDown) {
  SocketPair pair;
  int accepted = 0;
  while (accepted < 10'000 && pending_.Add(pair.ours(), AddressAt(kCrowded, 1), kNow)) ++accepted;
  EXPECT_EQ(accepted, static_cast<int>(kHandshakesPerNetwork.attempts_max));
  EXPECT_TRUE(Add(pair, kHonest));
  EXPECT_TRUE(pending_.Add(pair.ours(), AddressAt(kCrowded, 1), kNow + seconds(1)));
}

TEST(PeerTextOfGrpc, ReadsAddressesAsGrpcWritesThem) {
  EXPECT_EQ(PeerTextOfGrpc("ipv4:10.0.0.1:4711"), "10.0.0.1:4711");
  EXPECT_EQ(PeerTextOfGrpc("ipv6:%5B2001:db8::1%5D:4711"), "[2001:db8::1]:4711");
  EXPECT_EQ(PeerTextOfGrpc("ipv6:[2001:db8::1]:4711"), "[2001:db8::1]:4711");
  EXPECT_EQ(PeerTextOfGrpc("ipv6:%5Bfe80::1%25eth0%5D:4711"), "[fe80::1]:4711");
  for (const char* other : {"", "unix:", "unix:/tmp/socket", "ipv5:1"}) EXPECT_EQ(PeerTextOfGrpc(other), "");
}

}  // namespace
}  // namespace tessera
