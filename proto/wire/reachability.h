// Why no coordinator answers at an address, in words for users. gRPC's own texts depend on its state and say
// little, so a connection of our own finds out.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "proto/identity/certificate.h"
#include "proto/wire/endpoint.h"
#include "renderer/util/result.h"

namespace grpc {
class Status;
}

namespace tessera {

// Why an endpoint cannot be used, for those who decide what to do about it.
enum class Obstacle {
  kNone,
  kName,     // the host name has no address
  kRefused,  // nobody listens
  kTimeout,  // no answer
  kNoRoute,
  kOtherProgram,  // what answers is no coordinator
  kOtherFarm,     // the coordinator is not the one that is wanted
  kNotAdmitted,   // the coordinator does not accept our certificate
  kOther,
};

// What was found out about an endpoint.
struct Reachability {
  // Whether a server there speaks the protocol below gRPC: then the reason is in the answer to a call.
  bool speaks_http2 = false;
  // Why no coordinator answers; empty if speaks_http2. Examples: `the host name "x" is unknown`, `connection
  // refused: no program listens there`.
  std::string reason;
  Obstacle obstacle = speaks_http2 ? Obstacle::kNone : Obstacle::kOther;
};

// Resolves, connects, shows the certificate of a login and exchanges the first bytes of HTTP/2, on a thread
// of its own. Destruction ends it within milliseconds, unless it waits for a name server, which cannot be
// interrupted: then it outlives this object and ends with the answer. Not thread safe.
class ReachabilityCheck {
 public:
  explicit ReachabilityCheck(const Endpoint& endpoint);
  ~ReachabilityCheck();
  ReachabilityCheck(const ReachabilityCheck&) = delete;
  ReachabilityCheck& operator=(const ReachabilityCheck&) = delete;
  // Waits for the result, at most for `patience` or until a stop is requested.
  std::optional<Reachability> Await(std::chrono::milliseconds patience, std::stop_token stop = {});

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
  std::thread thread_;
};

// The result of a check that is given enough time to end.
Reachability CheckReachability(const Endpoint& endpoint, std::stop_token stop = {});

// The certificates that the coordinator at a TCP address shows, its own first. Nothing about them is
// verified.
Result<std::vector<Certificate>> FetchCertificates(const Address& address);

// Whether what listens at a TCP address is a web server, in plain text or with TLS.
bool IsWebServer(const Address& address, bool is_encrypted);

// Why a call failed with `status`, according to what was found out about the address.
std::string DescribeOutage(const Reachability& found, const grpc::Status& status);

}  // namespace tessera
