// The gRPC side of CoordinatorClient. Included by its sources alone: gRPC's headers are heavy.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "client/coordinator/coordinator_client.h"
#include "proto/blobs.grpc.pb.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/wire/channel.h"

namespace tessera {

constexpr std::chrono::seconds kCallPatience{60};  // for one answer
constexpr std::chrono::seconds kRetryPatience{
    60};  // for a coordinator that is away: one that starts again is back soon
// Between attempts; doubled after each that fails.
constexpr std::chrono::milliseconds kRetryFirst{50};
constexpr std::chrono::milliseconds kRetryMax{3000};

struct CoordinatorClient::Connection {
  std::string address;  // as the user wrote it
  std::stop_token stop;
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<proto::Jobs::Stub> jobs;
  std::unique_ptr<proto::Blobs::Stub> blobs;
};

// The context of one call, cancelled when a stop is requested.
class CallContext {
 public:
  // Waits for the connection if there is none; `patience` bounds the whole call.
  CallContext(std::stop_token stop, std::chrono::milliseconds patience) : on_stop_(stop, Cancel{context_}) {
    context_.set_wait_for_ready(true);
    SetDeadline(context_, patience);
  }
  // Without a bound: for streams that live as long as a job.
  explicit CallContext(std::stop_token stop) : on_stop_(stop, Cancel{context_}) {}
  grpc::ClientContext* get() { return &context_; }

 private:
  struct Cancel {
    grpc::ClientContext& context;
    void operator()() const { context.TryCancel(); }
  };
  grpc::ClientContext context_;
  std::stop_callback<Cancel> on_stop_;
};

// Waits for `duration` or until a stop is requested; whether it is worth going on.
inline bool Pause(std::stop_token stop, std::chrono::milliseconds duration) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, duration, [] { return false; });
  return !stop.stop_requested();
}

// Runs `attempt`, which makes one call and gives its status, until it succeeds, fails for good, was stopped
// or has failed for too long. `what` names it in errors. Every call of the protocol may be repeated.
template <typename Attempt>
Result<void> WithRetries(std::stop_token stop, const std::string& what, Attempt attempt) {
  const auto give_up = std::chrono::steady_clock::now() + kRetryPatience;
  for (std::chrono::milliseconds pause = kRetryFirst;;) {
    const grpc::Status status = attempt();
    if (status.ok()) return {};
    const bool again = status.error_code() == grpc::StatusCode::UNAVAILABLE &&
                       std::chrono::steady_clock::now() + pause < give_up;
    if (!again || !Pause(stop, pause)) return ToError(status, what);
    pause = std::min(pause * 2, kRetryMax);
  }
}

}  // namespace tessera
