// A flood of connections by peers that do not belong to the farm: silent ones, plain HTTP/2, random bytes,
// and TLS handshakes that stop half-way or end with a certificate that nobody knows.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "proto/wire/address.h"

namespace tessera {

class Flood {
 public:
  // Keeps up to `connections` open, and opens others as they are closed.
  Flood(const Address& victim, int connections);
  ~Flood();
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;

  uint64_t opened() const { return opened_; }
  uint64_t refused() const { return refused_; }
  // Connections on which the victim sent more than an alert after a handshake: there must be none.
  uint64_t answered() const { return answered_; }

 private:
  void Run(std::stop_token stop, const Address& victim, int connections, unsigned seed);

  std::atomic<uint64_t> opened_ = 0, refused_ = 0, answered_ = 0;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace tessera
