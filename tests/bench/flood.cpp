#include "tests/bench/flood.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <random>
#include <string_view>

#include "proto/identity/authority.h"
#include "proto/identity/subject.h"
#include "proto/identity/tls_probe.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPause{5};  // of each kind between two connections
constexpr std::chrono::milliseconds kHandshakePatience{200}, kAnswerPatience{2000};
// 127.66.0.0 to 127.66.15.255.
constexpr uint32_t kSourceNetwork = 0x7f420000, kSourceHosts = 0xfff;
// An answer to plain text would be a SETTINGS frame of HTTP/2 or a status line; a TLS alert has 7 bytes.
constexpr ssize_t kAlertBytes = 7;
constexpr std::string_view kHttp2 = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
constexpr size_t kNoiseBytes = 64 << 10;

std::string Noise() {
  std::mt19937 random;
  std::string bytes(kNoiseBytes, '\0');
  for (char& each : bytes) each = static_cast<char>(random());
  return bytes;
}

// A key and certificate that the farm does not know.
std::string UnknownIdentity() {
  CertificateTerms terms;
  terms.common_name = "stranger";
  terms.uri = Subject{Role::kOperator, MemberId{0xff}, {}}.Uri();
  terms.lifetime = std::chrono::hours(24);
  terms.serial = 9;
  const PrivateKey key = PrivateKey::Generate();
  return key.Pem() + MakeSelfSigned(key, terms, UnixNow()).Pem();
}

// The first message of a TLS handshake.
std::string ClientHello() {
  int ends[2] = {-1, -1};
  ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends);
  static_cast<void>(TlsProbe(ends[0], "").Handshake(Clock::now() + kHandshakePatience));
  std::string hello(4096, '\0');
  hello.resize(static_cast<size_t>(std::max<ssize_t>(::recv(ends[1], hello.data(), hello.size(), 0), 0)));
  for (const int end : ends) ::close(end);
  return hello;
}

bool Send(int socket, std::string_view bytes) {
  static_cast<void>(::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
  return false;
}

// Whether the victim answers after a handshake.
bool IsAnswered(int socket, const std::string& identity) {
  TlsProbe probe(socket, identity);
  if (!probe.Handshake(Clock::now() + kHandshakePatience)) return false;
  const auto deadline = Clock::now() + kAnswerPatience;
  return probe.Exchange(std::string(kHttp2) + std::string(9, '\0'), 9, deadline).has_value();
}

// Returns whether more than an alert had arrived. Leaves no state in which the kernel keeps the port for a
// minute.
bool CloseAnswered(int socket) {
  char bytes[64];
  const bool is_answered = ::recv(socket, bytes, sizeof bytes, MSG_DONTWAIT) > kAlertBytes;
  const linger none{1, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_LINGER, &none, sizeof none);
  ::close(socket);
  return is_answered;
}

}  // namespace

Flood::Flood(const Address& victim, int connections, std::string source)
    : victim_(victim), source_(std::move(source)) {
  const std::string hello = ClientHello();
  const auto send = [](std::string bytes) {
    return [bytes = std::move(bytes)](int socket) { return Send(socket, bytes); };
  };
  const auto shake = [](std::string identity) {
    return [identity = std::move(identity)](int socket) { return IsAnswered(socket, identity); };
  };
  const std::vector<Kind> kinds{{send("")},
                                {send(std::string(kHttp2))},
                                {send(Noise())},
                                {send(hello.substr(0, hello.size() / 2))},
                                {send(hello), true},
                                {shake(""), true},
                                {shake(UnknownIdentity()), true}};
  const auto held_max = std::max<size_t>(static_cast<size_t>(connections) / kinds.size(), 1);
  for (const Kind& kind : kinds) {
    threads_.emplace_back([this, held_max, kind, seed = static_cast<unsigned>(threads_.size() + 1)](
                              std::stop_token stop) { Run(stop, held_max, seed, kind); });
  }
}

Flood::~Flood() {
  Stop();
}

void Flood::Stop() {
  for (std::jthread& each : threads_) each.request_stop();
  threads_.clear();  // joins
}

int Flood::Connect(uint32_t source) const {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return -1;
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = source_.empty() ? htonl(source) : ::inet_addr(source_.c_str());
  const bool is_bound = ::bind(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0;
  name.sin_port = htons(static_cast<uint16_t>(victim_.port));
  ::inet_pton(AF_INET, victim_.host.c_str(), &name.sin_addr);
  if (is_bound && ::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0) {
    ::fcntl(socket, F_SETFL, O_NONBLOCK);
    return socket;
  }
  ::close(socket);
  return -1;
}

void Flood::Run(const std::stop_token& stop, size_t held_max, unsigned seed, const Kind& kind) {
  std::mt19937 random(seed);
  std::deque<int> held;
  const auto close_oldest = [&] {
    answered_ += CloseAnswered(held.front()) && !kind.shakes_hands ? 1 : 0;
    held.pop_front();
  };
  for (; !stop.stop_requested(); std::this_thread::sleep_for(kPause)) {
    if (held.size() >= held_max) close_oldest();
    const int socket = Connect(kSourceNetwork | (static_cast<uint32_t>(random()) & kSourceHosts));
    if (socket < 0) {
      ++refused_;
      continue;
    }
    ++opened_;
    answered_ += kind.act(socket) ? 1 : 0;
    held.push_back(socket);
  }
  while (!held.empty()) close_oldest();
}

}  // namespace tessera
