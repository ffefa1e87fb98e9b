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

struct CoordinatorClient::Connection {
  Endpoint endpoint;
  std::chrono::milliseconds patience;  // for repeating a call
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

// Decides which failed calls are made again, and waits before that: longer after each failure, and for at
// most `patience` since the first. Every call of the protocol may be repeated. Used by one thread.
class Retries {
 public:
  Retries(std::shared_ptr<grpc::Channel> channel, std::stop_token stop, std::chrono::milliseconds patience)
      : channel_(std::move(channel)), stop_(std::move(stop)), patience_(patience) {
    Progress();
  }
  // After a call that failed with `status`: waits and returns true if it should be made again.
  bool Again(const grpc::Status& status) {
    const auto wait = waits_.Next();
    const bool is_in_time = std::chrono::steady_clock::now() + wait < progress_at_ + patience_;
    return (IsTransient(status) || WasCutOff(status)) && is_in_time &&
           AwaitNextAttempt(*channel_, stop_, wait);
  }
  // The call got further before it failed: patience and waits start again.
  void Progress() {
    progress_at_ = std::chrono::steady_clock::now();
    waits_.Reset();
  }

 private:
  static constexpr std::chrono::milliseconds kWaitMax{3000};

  // Whether the coordinator cancelled the call, as it does with peers that stall and with members that are
  // revoked. The next call brings the reason.
  bool WasCutOff(const grpc::Status& status) const {
    return status.error_code() == grpc::StatusCode::CANCELLED && !stop_.stop_requested();
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const std::stop_token stop_;
  const std::chrono::milliseconds patience_;
  std::chrono::steady_clock::time_point progress_at_;
  Backoff waits_{RandomId(), kBackoffFirst, kWaitMax};
};

// Calls `attempt`, which makes one call and returns its status, until it succeeds or is not to be repeated
// (see Retries). Errors name the call as `what`.
template <typename Connection, typename Attempt>
Result<void> WithRetries(const Connection& connection, const std::string& what, Attempt attempt) {
  Retries retries(connection.channel, connection.stop, connection.patience);
  while (true) {
    const grpc::Status status = attempt();
    if (status.ok()) return {};
    if (!retries.Again(status)) return connection.ErrorOf(status, what);
  }
}

}  // namespace tessera
