// A member that sends the headers of a request without an end costs the coordinator a connection. What others
// send besides headers has no such limit.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>

#include "proto/identity/login.h"
#include "proto/wire/address.h"
#include "tests/coordinator/web/tls_client.h"
#include "tests/end_to_end/hostile_client.h"
#include "tests/end_to_end/membership_fixture.h"

namespace tessera {
namespace {

constexpr size_t kSentMax = size_t{64} << 20;
constexpr size_t kGrowthMax = size_t{16} << 20;

std::string Frame(char type, char flags, char stream, const std::string& payload) {
  const size_t size = payload.size();
  return std::string{static_cast<char>(size >> 16),
                     static_cast<char>(size >> 8),
                     static_cast<char>(size),
                     type,
                     flags,
                     0,
                     0,
                     0,
                     stream} +
         payload;
}

class EndlessHeaders : public MembershipOfAFarm {
 protected:
  EndlessHeaders() { LogIn("ada", "user"); }
  ~EndlessHeaders() override { std::signal(SIGPIPE, on_pipe_); }
  // Begins a request with these headers and repeats `frame` until the connection ends. Returns the bytes that
  // were sent.
  size_t Attack(const std::string& headers, const std::string& frame) {
    const auto login = LoginStore(Path("ada") + "/tessera/farms").List();
    EXPECT_EQ(login.size(), 1u);
    TlsClient client(ParseAddress(address(), "test")->port,
                     Bytes(login.front().IdentityPath().substr(folder().size() + 1)));
    constexpr unsigned char kProtocols[] = "\x02h2";
    SSL_set_alpn_protos(client.ssl(), kProtocols, sizeof kProtocols - 1);
    EXPECT_TRUE(client.Handshake());
    EXPECT_TRUE(client.Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(kSettings, 0, 0, "")));
    EXPECT_FALSE(client.ReadSome().empty()) << "gRPC serves the connection";
    EXPECT_TRUE(client.Send(Frame(kHeaders, 0, 1, headers)));
    size_t sent = 0;
    while (sent < kSentMax && client.Send(frame)) sent += frame.size();
    return sent;
  }
  // Runs an attack and expects that others notice nothing.
  void ExpectBounded(const std::string& headers, const std::string& frame) {
    const uint64_t before = PeakBytes(coordinator().pid());
    const size_t sent = Attack(headers, frame);
    EXPECT_LT(sent, kSentMax) << "the connection ends";
    EXPECT_TRUE(coordinator().AwaitErrors("connection_closed count=1 member="));
    EXPECT_THAT(coordinator().Errors(), testing::HasSubstr("the headers of a request exceed 32768 bytes"));
    EXPECT_LT(PeakBytes(coordinator().pid()) - before, MemoryBound(kGrowthMax));
    const Outcome outcome = As("ada", "jobs");
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
  }
  static constexpr char kHeaders = 1, kSettings = 4, kContinuation = 9;

 private:
  // Ignores the signal of a write to a closed connection.
  void (*const on_pipe_)(int) = std::signal(SIGPIPE, SIG_IGN);
};

// HPACK (RFC 7541): a literal without an index, with the length of its name and of its value.
TEST_F(EndlessHeaders, ManyHeadersInManyFramesEndTheConnection) {
  const std::string header = std::string("\0\1x\3", 4) + "abc";
  std::string payload;
  for (int i = 0; i < 200; ++i) payload += header;
  ExpectBounded(header, Frame(kContinuation, 0, 1, payload));
}

// A header that was entered into the table is one byte from then on, and some 70 bytes in memory.
TEST_F(EndlessHeaders, HeadersOfOneByteEndTheConnection) {
  ExpectBounded("\x40\1x\1y", Frame(kContinuation, 0, 1, std::string(200, '\xbe')));
}

TEST_F(EndlessHeaders, AValueOfTwoGigabytesEndsTheConnection) {
  const std::string length = "\x7f\x80\xff\xff\xff\x07";
  ExpectBounded(std::string("\0\1x", 3) + length, Frame(kContinuation, 0, 1, std::string(16384, 'A')));
}

// The bytes of all frames of a connection, of many requests, exceed the limit of the headers of one request.
TEST_F(EndlessHeaders, ALargeUploadPasses) {
  constexpr size_t kFileBytes = size_t{16} << 20;
  std::string comments;
  for (size_t i = 0; comments.size() < kFileBytes; ++i) comments += "# " + std::to_string(i * i) + "\n";
  Write("comments.pbrt", comments);
  const std::string scene = Write(
      "large.pbrt", "Include \"comments.pbrt\"\nWorldBegin\nLightSource \"infinite\"\nShape \"sphere\"\n");
  const Outcome submitted = As("ada", "submit " + scene + " --spp 1");
  EXPECT_EQ(submitted.code, 0) << submitted.errors;
  EXPECT_THAT(coordinator().Errors(),
              testing::HasSubstr(fmt::format("bytes={} result=done", comments.size())))
      << "it is one upload";
  EXPECT_THAT(coordinator().Errors(), testing::Not(testing::HasSubstr("connection_closed")));
}

}  // namespace
}  // namespace tessera
