// Strangers who connect to a farm as often as they can: silent ones, plain HTTP/2, random bytes, TLS
// handshakes that stop half-way or wait for more, and such as end without a certificate or with one that
// nobody knows.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "proto/wire/address.h"

namespace tessera {

class Flood {
 public:
  // Keeps up to `connections` open, and closes the oldest to open others. They come from `source`, or, if it
  // is empty, from some thousand addresses of 127.66.0.0/20: a network that makes too many connections loses
  // its own.
  Flood(const Address& victim, int connections, std::string source = "");
  ~Flood();
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;

  // Closes all connections and opens no others. The counts stay.
  void Stop();

  uint64_t opened() const { return opened_; }
  uint64_t refused() const { return refused_; }
  // Connections on which the victim sent more than an alert after a handshake: there must be none.
  uint64_t answered() const { return answered_; }

 private:
  struct Kind {
    // What a stranger does with a connection. Returns whether it was answered.
    std::function<bool(int socket)> act;
    bool shakes_hands = false;  // what arrives may be a handshake, which anybody may see
  };
  void Run(const std::stop_token& stop, size_t held_max, unsigned seed, const Kind& kind);
  int Connect(uint32_t source) const;

  const Address victim_;
  const std::string source_;
  std::atomic<uint64_t> opened_ = 0, refused_ = 0, answered_ = 0;
  std::vector<std::jthread> threads_;  // one for each kind; last: they use the others
};

}  // namespace tessera
