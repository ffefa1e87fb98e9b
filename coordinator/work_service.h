// Serves proto/work.proto: turns calls into events of the core thread. Thread safe.
#pragma once

#include <atomic>

#include "proto/work.grpc.pb.h"

namespace tessera {

class CoreThread;

class WorkService final : public proto::Work::CallbackService {
 public:
  explicit WorkService(CoreThread& core) : core_(core) {}

  grpc::ServerUnaryReactor* Synchronize(grpc::CallbackServerContext* context,
                                        const proto::WorkerState* request,
                                        proto::WorkerDirective* answer) override;
  grpc::ServerUnaryReactor* ReturnResults(grpc::CallbackServerContext* context,
                                          const proto::ResultsRequest* request,
                                          proto::ResultsAnswer* answer) override;
  grpc::ServerUnaryReactor* ReturnFailure(grpc::CallbackServerContext* context,
                                          const proto::FailureRequest* request,
                                          proto::FailureAnswer* answer) override;

 private:
  CoreThread& core_;
  std::atomic<uint64_t> call_next_{1};
};

}  // namespace tessera
