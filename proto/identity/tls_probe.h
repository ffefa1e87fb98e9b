// A TLS 1.3 connection to a coordinator for a look at it: which certificates it shows, and whether it accepts
// ours. Verifies nothing by itself. gRPC gives no reason when a handshake fails.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "proto/identity/certificate.h"
#include "renderer/util/result.h"

namespace tessera {

class TlsProbe {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  // `socket` is connected, does not block and stays the caller's. `identity_pem` holds the key and
  // certificates to show; empty: none.
  TlsProbe(int socket, const std::string& identity_pem);
  ~TlsProbe();
  TlsProbe(const TlsProbe&) = delete;
  TlsProbe& operator=(const TlsProbe&) = delete;

  // The error is what OpenSSL knows of it. With TLS 1.3, the other end checks our certificate only after
  // this.
  Result<void> Handshake(TimePoint deadline);
  // What the other end has shown, its own certificate first.
  std::vector<Certificate> PeerChain() const;
  // Sends `bytes`, then receives at least one byte and at most `size_max`.
  Result<std::string> Exchange(std::string_view bytes, size_t size_max, TimePoint deadline);

 private:
  struct State;
  // Waits until the step `result` of OpenSSL can be tried again. An error if it failed for good.
  Result<void> AwaitAfter(int result, TimePoint deadline);
  std::unique_ptr<State> state_;
};

}  // namespace tessera
