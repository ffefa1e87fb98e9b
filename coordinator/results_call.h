// One ReturnResults call of proto/work.proto.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <optional>

#include "coordinator/core/farm.h"
#include "proto/work.pb.h"

namespace tessera {

class CoreThread;
class ResultsIntake;

// Reads the announcement, waits until the results are admitted, reads them, passes them to the core and sends
// its answer. Deletes itself when the call is over.
class ResultsCall final : public grpc::ServerReadReactor<proto::ResultsRequest> {
 public:
  // Adds the bytes read to `bytes_in`.
  ResultsCall(CoreThread& core, ResultsIntake& intake, CallId id, proto::ResultsAnswer& answer,
              std::atomic<uint64_t>& bytes_in);

 private:
  void OnReadDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  void Announced();
  void Received();
  void Answer(const FarmOutput::Results* results);

  CoreThread& core_;
  ResultsIntake& intake_;
  const CallId id_;
  proto::ResultsAnswer& answer_;
  std::atomic<uint64_t>& bytes_in_;
  std::optional<proto::ResultsRequest> request_;  // released as soon as its results are decoded
  WorkerId worker_{};
  uint64_t bytes_ = 0;  // announced; 0 before
  bool admitted_ = false;
};

}  // namespace tessera
