// The gRPC side of CoordinatorClient. Only its sources include this: gRPC's headers are slow to compile.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <chrono>
#include <map>
#include <memory>
#include <stop_token>
#include <string>

#include "client/coordinator/coordinator_client.h"
#include "proto/access.grpc.pb.h"
#include "proto/blobs.grpc.pb.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/shell/backoff.h"
#include "proto/shell/pause.h"
#include "proto/shell/system.h"
#include "proto/wire/channel.h"

namespace tessera {

constexpr std::chrono::seconds kCallPatience{60};  // for one answer
// For a coordinator that is away. One that restarts is back sooner.
constexpr std::chrono::seconds kRetryPatience{60};
constexpr std::chrono::milliseconds kRetryMax{3000};  // between two attempts

// The waits between attempts of one call.
inline Backoff RetryWaits() {
  return Backoff(RandomId(), kBackoffFirst, kRetryMax);
}

struct CoordinatorClient::Connection {
  Endpoint endpoint;
  std::stop_token stop;
  FarmId farm;                            // that answered first; every later call is meant for it
  std::map<JobId, uint64_t> submissions;  // of the jobs that were submitted over this connection
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<proto::Jobs::Stub> jobs;
  std::unique_ptr<proto::Blobs::Stub> blobs;
  std::unique_ptr<proto::Access::Stub> access;

  // The error of a call, `what`, that failed for good. If the coordinator does not answer, finds out why.
  Error ErrorOf(const grpc::Status& status, const std::string& what) const;
};

// The context of one call to the farm of a connection, which is cancelled when a stop is requested.
class CallContext {
 public:
  // Waits for a connection if there is none. `patience` limits the whole call.
  CallContext(std::stop_token stop, FarmId farm, std::chrono::milliseconds patience)
      : CallContext(std::move(stop), farm) {
    context_.set_wait_for_ready(true);
    SetDeadline(context_, patience);
  }
  // Without a limit, for streams that live as long as a job.
  CallContext(std::stop_token stop, FarmId farm) : on_stop_(std::move(stop), Cancel{context_}) {
    SetFarm(context_, farm);
  }
  grpc::ClientContext* get() { return &context_; }

 private:
  struct Cancel {
    grpc::ClientContext& context;
    void operator()() const { context.TryCancel(); }
  };
  grpc::ClientContext context_;
  std::stop_callback<Cancel> on_stop_;
};

// Waits before another attempt, and then for a connection: with TLS, it is only made while somebody waits for
// it, and a call that does not wait would find none every time. Returns false if a stop is requested.
inline bool AwaitNextAttempt(grpc::Channel& channel, const std::stop_token& stop,
                             std::chrono::milliseconds wait) {
  constexpr std::chrono::milliseconds kSlice{100};  // how long a stop may go unnoticed
  constexpr int kSlices = 100;                      // longer than an attempt to connect
  if (!Pause(stop, wait)) return false;
  for (int i = 0; i < kSlices && !stop.stop_requested(); ++i) {
    if (WaitForConnection(channel, kSlice)) break;
  }
  return !stop.stop_requested();
}

// Whether the coordinator cancelled the call, as it does with peers that stall and with members that are
// revoked. The next call brings the reason.
inline bool WasCutOff(const grpc::Status& status, const std::stop_token& stop) {
  return status.error_code() == grpc::StatusCode::CANCELLED && !stop.stop_requested();
}

// Calls `attempt`, which makes one call and returns its status, until it succeeds, fails with an error that
// does not pass, a stop is requested, or kRetryPatience is over. Errors name the call as `what`. Every call
// of the protocol may be repeated.
template <typename Connection, typename Attempt>
Result<void> WithRetries(const Connection& connection, const std::string& what, Attempt attempt) {
  const auto deadline = std::chrono::steady_clock::now() + kRetryPatience;
  Backoff waits = RetryWaits();
  while (true) {
    const grpc::Status status = attempt();
    if (status.ok()) return {};
    const auto wait = waits.Next();
    const bool may_pass =
        status.error_code() == grpc::StatusCode::UNAVAILABLE || WasCutOff(status, connection.stop);
    const bool retry = may_pass && std::chrono::steady_clock::now() + wait < deadline;
    if (!retry || !AwaitNextAttempt(*connection.channel, connection.stop, wait))
      return connection.ErrorOf(status, what);
  }
}

}  // namespace tessera
