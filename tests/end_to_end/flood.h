// Strangers who connect as often as they can, each kind on a thread of its own until the end of the object.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <string>
#include <thread>
#include <vector>

#include "proto/identity/authority.h"
#include "proto/identity/subject.h"
#include "proto/identity/tls_probe.h"

namespace tessera {

class Flood {
 public:
  // To 127.0.0.1:PORT, from `source`.
  Flood(int port, std::string source) : port_(port), source_(std::move(source)) {
    const PrivateKey key = PrivateKey::Generate();
    CertificateTerms terms;
    terms.common_name = "stranger";
    terms.uri = Subject{Role::kOperator, MemberId{1}, {}}.Uri();
    terms.lifetime = std::chrono::hours(1);
    terms.serial = 1;
    const std::string forged = key.Pem() + MakeSelfSigned(key, terms, UnixNow()).Pem();
    const std::string hello = ClientHello();
    Run([](int) {});
    Run([hello](int socket) { Send(socket, hello); });
    Run([hello](int socket) { Send(socket, hello.substr(0, hello.size() / 2)); });
    Run([](int socket) { Send(socket, std::string(64 << 10, 'x')); });
    Run([](int socket) { Handshake(socket, ""); });
    Run([forged](int socket) { Handshake(socket, forged); });
  }
  ~Flood() {
    stopping_ = true;
    for (std::thread& each : threads_) each.join();
  }
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;
  int made() const { return made_; }

 private:
  static constexpr size_t kHeldMax = 100;  // of each kind
  static constexpr int kPause_ms = 5;
  static constexpr std::chrono::milliseconds kHandshakePatience{200};

  template <typename Act>
  void Run(Act act) {
    threads_.emplace_back([this, act] {
      std::deque<int> held;
      while (!stopping_) {
        if (const int socket = Connect(); socket >= 0) {
          act(socket);
          held.push_back(socket);
        }
        if (held.size() > kHeldMax) {
          Close(held.front());
          held.pop_front();
        }
        ::poll(nullptr, 0, kPause_ms);
      }
      for (const int each : held) Close(each);
    });
  }
  int Connect() {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_addr.s_addr = ::inet_addr(source_.c_str());
    const bool is_bound = ::bind(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0;
    name.sin_port = htons(static_cast<uint16_t>(port_));
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (is_bound && ::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0) {
      ++made_;
      ::fcntl(socket, F_SETFL, O_NONBLOCK);
      return socket;
    }
    ::close(socket);
    return -1;
  }
  // Without the state in which the kernel keeps the port for a minute.
  static void Close(int socket) {
    const linger none{1, 0};
    ::setsockopt(socket, SOL_SOCKET, SO_LINGER, &none, sizeof none);
    ::close(socket);
  }
  static void Send(int socket, const std::string& bytes) {
    ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  static void Handshake(int socket, const std::string& identity) {
    const auto deadline = std::chrono::steady_clock::now() + kHandshakePatience;
    static_cast<void>(TlsProbe(socket, identity).Handshake(deadline));
  }
  static std::string ClientHello() {
    int ends[2] = {-1, -1};
    ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends);
    Handshake(ends[0], "");
    std::string hello(4096, '\0');
    hello.resize(static_cast<size_t>(std::max<ssize_t>(::recv(ends[1], hello.data(), hello.size(), 0), 0)));
    for (const int end : ends) ::close(end);
    return hello;
  }

  const int port_;
  const std::string source_;
  std::atomic<bool> stopping_ = false;
  std::atomic<int> made_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace tessera
