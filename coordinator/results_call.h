// One call of proto/work.proto's ReturnResults.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <optional>

#include "coordinator/core/farm.h"
#include "proto/work.pb.h"

namespace tessera {

class CoreThread;
class ResultsIntake;

// Reads the announcement, waits until the results are let in, reads them, hands them to the core and gives
// its answer. Deletes itself when the call is over.
class ResultsCall final : public grpc::ServerReadReactor<proto::ResultsRequest> {
 public:
  // `bytes_in` counts what was read.
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
  std::optional<proto::ResultsRequest> request_;  // gone as soon as its results are read from it
  WorkerId worker_{};
  uint64_t bytes_ = 0;  // announced; 0 before
  bool admitted_ = false;
};

}  // namespace tessera
