// Serves proto/work.proto: each call becomes an event of the core thread. Thread safe.
#pragma once

#include <atomic>
#include <thread>

#include "coordinator/results_intake.h"
#include "proto/work.grpc.pb.h"

namespace tessera {

class CallGate;
class Farm;
struct WorkerState;

// Whether the sender of the state may join now: FAILED_PRECONDITION if it never may, RESOURCE_EXHAUSTED if
// the farm is full.
grpc::Status CheckJoin(const Farm& farm, const WorkerState& state);

class WorkService final : public proto::Work::Service {
 public:
  explicit WorkService(const CallGate& gate);
  // Bytes of results received since the start.
  uint64_t bytes_in() const { return bytes_in_; }
  const ResultsIntake& intake() const { return intake_; }

  grpc::ServerUnaryReactor* Synchronize(grpc::CallbackServerContext* context,
                                        const proto::WorkerState* request, proto::WorkerDirective* answer);
  grpc::ServerReadReactor<grpc::ByteBuffer>* ReturnResults(grpc::CallbackServerContext* context,
                                                           proto::ResultsAnswer* answer);
  grpc::ServerUnaryReactor* ReturnPreparation(grpc::CallbackServerContext* context,
                                              const proto::PreparationReport* request,
                                              proto::PreparationAnswer* answer);
  grpc::ServerUnaryReactor* ReturnFailure(grpc::CallbackServerContext* context,
                                          const proto::FailureRequest* request, proto::FailureAnswer* answer);

 private:
  void ExpireAnnouncements(std::stop_token stop);

  const CallGate& gate_;
  ResultsIntake intake_{kIntakeBytesMax};
  std::atomic<uint64_t> call_next_{1};
  std::atomic<uint64_t> bytes_in_{0};
  std::jthread expiry_;  // last: it ends before the intake
};

}  // namespace tessera
