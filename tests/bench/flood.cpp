#include "tests/bench/flood.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <deque>
#include <random>
#include <string>

#include "proto/identity/authority.h"
#include "proto/identity/tls_probe.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kThreads = 2;
constexpr std::chrono::milliseconds kPause{2};  // between connections: some hundred a second
// 127.66.0.0 to 127.66.15.255.
constexpr uint32_t kSourceNetwork = 0x7f420000, kSourceHosts = 0xfff;
// An answer to plain text would be a SETTINGS frame of HTTP/2 or a status line; a TLS alert has 7 bytes.
constexpr ssize_t kAlertBytes = 7;
constexpr std::string_view kHttp2 = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
// A TLS record that announces a ClientHello of 512 bytes, which never come.
constexpr std::string_view kHalfHello("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11);

// From other addresses than those of honest peers: a network that makes too many connections loses its own.
int Connect(const Address& victim, std::mt19937& random) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return -1;
  sockaddr_in source{};
  source.sin_family = AF_INET;
  source.sin_addr.s_addr = htonl(kSourceNetwork | (random() & kSourceHosts));
  (void)::bind(socket, reinterpret_cast<const sockaddr*>(&source), sizeof source);
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_port = htons(static_cast<uint16_t>(victim.port));
  ::inet_pton(AF_INET, victim.host.c_str(), &name.sin_addr);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0) {
    ::fcntl(socket, F_SETFL, O_NONBLOCK);
    return socket;
  }
  ::close(socket);
  return -1;
}

std::string Noise(std::mt19937& random) {
  std::string bytes(256, '\0');
  for (char& each : bytes) each = static_cast<char>(random());
  return bytes;
}

// A key and certificate that the farm does not know.
std::string UnknownIdentity() {
  CertificateTerms terms;
  terms.common_name = "stranger";
  terms.uri = "tessera:operator/00000000000000ff";
  terms.lifetime = std::chrono::hours(24);
  terms.serial = 9;
  const PrivateKey key = PrivateKey::Generate();
  return key.Pem() + MakeSelfSigned(key, terms, UnixNow()).Pem();
}

// Whether the victim answers after a handshake with a certificate that it does not know.
bool IsAnswered(int socket, const std::string& identity) {
  const auto deadline = Clock::now() + std::chrono::seconds(2);
  TlsProbe probe(socket, identity);
  if (!probe.Handshake(deadline)) return false;
  return probe.Exchange(std::string(kHttp2) + std::string(9, '\0'), 9, deadline).has_value();
}

}  // namespace

Flood::Flood(const Address& victim, int connections) {
  for (unsigned i = 0; i < kThreads; ++i)
    threads_.emplace_back(
        [=, this](std::stop_token stop) { Run(stop, victim, connections / kThreads, i + 1); });
}

Flood::~Flood() {
  for (std::jthread& each : threads_) each.request_stop();
}

void Flood::Run(std::stop_token stop, const Address& victim, int connections, unsigned seed) {
  std::mt19937 random(seed);
  const std::string identity = UnknownIdentity();
  std::deque<int> open;
  const auto close_oldest = [&] {
    char bytes[64];
    if (::recv(open.front(), bytes, sizeof bytes, MSG_DONTWAIT) > kAlertBytes) ++answered_;
    ::close(open.front());
    open.pop_front();
  };
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(kPause);
    if (open.size() >= static_cast<size_t>(connections)) close_oldest();
    const int socket = Connect(victim, random);
    if (socket < 0) {
      ++refused_;
      continue;
    }
    ++opened_;
    const auto send = [&](std::string_view bytes) {
      (void)::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    };
    switch (random() % 5) {
      case 0: break;  // silent
      case 1: send(kHttp2); break;
      case 2: send(Noise(random)); break;
      case 3: send(kHalfHello); break;
      case 4:
        answered_ += IsAnswered(socket, identity) ? 1 : 0;
        // What a handshake that took too long left in the socket is the certificate, which anybody may see.
        ::close(socket);
        continue;
    }
    open.push_back(socket);
  }
  while (!open.empty()) close_oldest();
}

}  // namespace tessera
