#include "proto/wire/reachability.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <thread>
#include <vector>

#include "proto/wire/probe_socket.h"
#include "proto/work.grpc.pb.h"
#include "tests/listening_socket.h"

namespace tessera {
namespace {

using testing::HasSubstr;

Address Local(int port) {
  Address address;
  address.host = "127.0.0.1";
  address.port = port;
  return address;
}

Address UnixAddress(const std::string& path) {
  return *ParseAddress("unix:" + path, "test");
}

// What is found at the address of a program that answers each connection with `bytes` and closes it.
Reachability CheckAnswerOf(const std::string& bytes) {
  const ListeningSocket listener(4);
  std::jthread server([&] {
    const int peer = ::accept(listener.fd(), nullptr, nullptr);
    char greeting[64];
    EXPECT_GT(::recv(peer, greeting, sizeof greeting, 0), 0);
    EXPECT_EQ(::send(peer, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
    ::shutdown(peer, SHUT_WR);
    while (::recv(peer, greeting, sizeof greeting, 0) > 0) {
    }
    ::close(peer);
  });
  return CheckReachability(Local(listener.port()));
}

TEST(Reachability, NamesAnUnknownHost) {
  Address address = Local(7700);
  address.host = "no-such-host.invalid";
  const Reachability found = CheckReachability(address);
  EXPECT_FALSE(found.speaks_http2);
  EXPECT_THAT(found.reason, HasSubstr("\"no-such-host.invalid\""));
}

TEST(Reachability, NamesARefusedConnection) {
  int port = 0;
  { port = ListeningSocket(1).port(); }
  EXPECT_THAT(CheckReachability(Local(port)).reason, HasSubstr("refused"));
}

TEST(Reachability, NamesAMachineThatDoesNotAnswer) {
  const ListeningSocket listener(0);
  // A full queue drops further connections, as a machine does that is not there.
  std::vector<int> queued;
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  name.sin_port = htons(static_cast<uint16_t>(listener.port()));
  for (int i = 0; i < 4; ++i) {
    queued.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    static_cast<void>(::connect(queued.back(), reinterpret_cast<sockaddr*>(&name), sizeof name));
  }
  EXPECT_THAT(CheckReachability(Local(listener.port())).reason, HasSubstr("timed out: the machine"));
  for (const int each : queued) ::close(each);
}

TEST(Reachability, NamesAProgramThatListensButDoesNotAnswer) {
  const ListeningSocket listener(8);
  EXPECT_THAT(CheckReachability(Local(listener.port())).reason, HasSubstr("timed out: the program"));
}

// A thread that is left behind would use libraries that are being unloaded when the program ends.
TEST(Reachability, ACheckThatIsGivenUpHasEndedItsConnection) {
  const ListeningSocket listener(8);
  std::optional<ReachabilityCheck> check(std::in_place, Local(listener.port()));
  const int peer = ::accept(listener.fd(), nullptr, nullptr);
  char greeting[64];
  EXPECT_GT(::recv(peer, greeting, sizeof greeting, 0), 0);
  check.reset();
  EXPECT_EQ(::recv(peer, greeting, sizeof greeting, MSG_DONTWAIT), 0);
  ::close(peer);
}

TEST(Reachability, NoConnectionStartsAfterAnInterruption) {
  const ListeningSocket listener(8);
  Interruption interruption;
  EXPECT_FALSE(interruption.Request());
  EXPECT_NE(Resolve("127.0.0.1", listener.port(), interruption).error, 0);
  const ProbeSocket socket(AF_INET, interruption);
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  name.sin_port = htons(static_cast<uint16_t>(listener.port()));
  EXPECT_EQ(socket.Connect(reinterpret_cast<sockaddr*>(&name), sizeof name,
                           std::chrono::steady_clock::now() + std::chrono::seconds(60)),
            ECONNABORTED);
}

TEST(Reachability, NamesProgramsThatAreNoCoordinator) {
  for (const char* answer : {"HTTP/1.1 400 Bad Request\r\n\r\n", "SSH-2.0-OpenSSH_9.2\r\n", "\x15\x03\x01"}) {
    const Reachability found = CheckAnswerOf(answer);
    EXPECT_FALSE(found.speaks_http2);
    EXPECT_THAT(found.reason, HasSubstr("not a Tessera coordinator")) << answer;
  }
}

TEST(Reachability, NamesAProgramThatClosesConnections) {
  EXPECT_THAT(CheckAnswerOf("").reason, HasSubstr("closes connections without an answer"));
}

TEST(Reachability, NamesAMissingSocket) {
  EXPECT_THAT(CheckReachability(UnixAddress("/no-such-folder/socket")).reason, HasSubstr("does not exist"));
}

TEST(Reachability, FindsAServerOfGrpc) {
  int port = 0;
  proto::Work::CallbackService service;
  grpc::ServerBuilder builder;
  builder.RegisterService(&service);
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  const std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  const Reachability found = CheckReachability(Local(port));
  EXPECT_TRUE(found.speaks_http2) << found.reason;
  EXPECT_EQ(found.reason, "");
}

}  // namespace
}  // namespace tessera
