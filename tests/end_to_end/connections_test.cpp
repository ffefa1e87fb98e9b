// More connections than a coordinator may have descriptors.
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr int kWorkers = 600;
constexpr int kConnectionsPerWorker = 2;
constexpr int kSilent = 1100;
constexpr rlim_t kDescriptors = 1024;
constexpr std::chrono::seconds kJoinPatience{5};

// TCP connections to one address, closed together.
class Connections {
 public:
  explicit Connections(const std::string& address)
      : port_(std::stoi(address.substr(address.rfind(':') + 1))) {}
  ~Connections() { CloseAll(); }
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;

  // A connection that sends nothing.
  void OpenSilent() {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    ASSERT_GE(socket, 0) << "the test itself has no descriptors";
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(static_cast<uint16_t>(port_));
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    sockets_.push_back(socket);
  }
  // A connection that completes the handshake of HTTP/2, as each channel of a worker does.
  void OpenLikeAChannel() {
    OpenSilent();
    const std::string preface("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);
    static_cast<void>(::send(sockets_.back(), preface.data(), preface.size(), MSG_NOSIGNAL));
  }
  // Connections that the coordinator has not closed.
  int CountOpen() const {
    int open = 0;
    for (const int socket : sockets_) {
      pollfd polled{socket, POLLIN | POLLRDHUP, 0};
      ::poll(&polled, 1, 0);
      if ((polled.revents & (POLLRDHUP | POLLHUP | POLLERR)) == 0) ++open;
    }
    return open;
  }
  void CloseAll() {
    for (const int socket : sockets_) ::close(socket);
    sockets_.clear();
  }

 private:
  int port_;
  std::vector<int> sockets_;
};

class ManyConnections : public EndToEnd {
 protected:
  // The test holds the other ends.
  ManyConnections() {
    ::getrlimit(RLIMIT_NOFILE, &limit_);
    SetOwnLimit(limit_.rlim_max);
  }
  ~ManyConnections() override { SetOwnLimit(limit_.rlim_cur); }

  void SetOwnLimit(rlim_t soft) {
    const rlimit limit{soft, limit_.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
  }
  bool Joins(const std::string& name, std::chrono::milliseconds patience) {
    return Eventually([&] { return Ask({"workers"}).output.find(name) != std::string::npos; }, patience);
  }
  void OpenMany(Connections& connections) {
    for (int i = 0; i < kWorkers * kConnectionsPerWorker; ++i) connections.OpenLikeAChannel();
    for (int i = 0; i < kSilent; ++i) connections.OpenSilent();
  }

  rlimit limit_{};
};

TEST_F(ManyConnections, TheCoordinatorRaisesItsDescriptorLimitAndServesThemAll) {
  constexpr int kAll = kWorkers * kConnectionsPerWorker + kSilent;
  if (limit_.rlim_max < 2 * kAll) GTEST_SKIP() << "the hard limit of descriptors is too low";
  SetOwnLimit(kDescriptors);
  StartCoordinator({"--insecure"});
  SetOwnLimit(limit_.rlim_max);
  Connections connections(address());
  OpenMany(connections);
  StartWorker("during");
  EXPECT_TRUE(Joins("during", kProcessPatience)) << coordinator().Errors();
  EXPECT_GE(connections.CountOpen(), kWorkers * kConnectionsPerWorker);
  EXPECT_THAT(coordinator().Errors(), testing::Not(HasSubstr("refused")));
}

TEST_F(ManyConnections, BeyondTheLimitAreRefusedAndWorkersJoinAgainWhenTheyAreClosed) {
  StartCoordinator({"--insecure"});
  const rlimit limit{kDescriptors, kDescriptors};
  ASSERT_EQ(::prlimit(coordinator().pid(), RLIMIT_NOFILE, &limit, nullptr), 0);
  StartWorker("early");
  ASSERT_TRUE(Joins("early", kProcessPatience));
  Connections connections(address());
  OpenMany(connections);
  EXPECT_TRUE(coordinator().AwaitErrors("connections_refused"));
  // The worker that was there is served, with descriptors for what it returns.
  StartWorker("waiting");
  connections.CloseAll();
  EXPECT_TRUE(Joins("waiting", kJoinPatience)) << coordinator().Errors();
  const std::string job = Submit(BoxScene(), {"--spp", "4", "--resolution", "64x36"});
  EXPECT_EQ(Ask({"watch", job}).code, 0);
}

// Without any descriptor left, accepting starts again as soon as there are some.
TEST_F(ManyConnections, AfterDescriptorsRanOutConnectionsAreAcceptedAgain) {
  StartCoordinator({"--insecure"});
  StartWorker("early");
  ASSERT_TRUE(Joins("early", kProcessPatience));
  rlimit before{};
  const rlimit none{8, limit_.rlim_max};
  ASSERT_EQ(::prlimit(coordinator().pid(), RLIMIT_NOFILE, &none, &before), 0);
  Connections connections(address());
  for (int i = 0; i < 20; ++i) connections.OpenSilent();
  EXPECT_TRUE(coordinator().AwaitErrors("accept_failed"));
  ASSERT_EQ(::prlimit(coordinator().pid(), RLIMIT_NOFILE, &before, nullptr), 0);
  StartWorker("late");
  EXPECT_TRUE(Joins("late", kProcessPatience)) << coordinator().Errors();
}

}  // namespace
}  // namespace tessera
