// Why no coordinator answers at an address, in words for users. gRPC's own texts depend on its state and say
// little, so a connection of our own finds out.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "proto/wire/address.h"

namespace grpc {
class Status;
}

namespace tessera {

// What was found out about an address.
struct Reachability {
  // Whether a server there speaks the protocol below gRPC: then the reason is in the answer to a call.
  bool speaks_http2 = false;
  // Why no coordinator answers; empty if speaks_http2. Examples: `the host name "x" is unknown`, `connection
  // refused: no program listens there`.
  std::string reason;
};

// Resolves, connects and exchanges the first bytes of HTTP/2, on a thread of its own, which may outlive this
// object: a name server that does not answer cannot be interrupted. Not thread safe.
class ReachabilityCheck {
 public:
  explicit ReachabilityCheck(const Address& address);
  // Waits for the result, at most for `patience` or until a stop is requested.
  std::optional<Reachability> Await(std::chrono::milliseconds patience, std::stop_token stop = {});

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

// The result of a check that is given enough time to end.
Reachability CheckReachability(const Address& address, std::stop_token stop = {});

// Why a call failed with `status`, according to what was found out about the address.
std::string DescribeOutage(const Reachability& found, const grpc::Status& status);

}  // namespace tessera
