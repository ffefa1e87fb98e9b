// One ReturnResults call of proto/work.proto.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "coordinator/core/farm.h"
#include "coordinator/open_calls.h"
#include "proto/work.pb.h"

namespace tessera {

class CallGate;
class ResultsIntake;
struct CoreContext;

// Reads the announcement, waits until the results are admitted, reads them, passes them to the core and sends
// its answer. Deletes itself when the call is over.
class ResultsCall final : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  // Adds the bytes read to `bytes_in`.
  ResultsCall(const CallGate& gate, ResultsIntake& intake, LastingCall call, CallId id,
              proto::ResultsAnswer& answer, std::atomic<uint64_t>& bytes_in);

 private:
  void OnReadDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  // How other threads cancel the call while it runs.
  struct Canceller {
    std::mutex mutex;
    grpc::CallbackServerContext* context = nullptr;  // null once the call is over; guarded by mutex
  };

  grpc::Status Read();
  grpc::Status Announced(const proto::ResultsRequest& announcement);
  grpc::Status Received(const proto::ResultsRequest& results);
  grpc::Status PassOn(CoreContext& core, std::vector<ReturnedUnit> units);
  void Answer(const FarmOutput::Results* results);

  const CallGate& gate_;
  ResultsIntake& intake_;
  const LastingCall call_;
  const std::shared_ptr<Canceller> canceller_;
  const CallId id_;
  proto::ResultsAnswer& answer_;
  std::atomic<uint64_t>& bytes_in_;
  grpc::ByteBuffer received_;
  WorkerId worker_{};
  FarmId farm_;                 // whose leases the results are of
  uint64_t bytes_ = 0;          // announced; 0 before
  uint64_t decoded_bytes_ = 0;  // announced
  bool admitted_ = false;
};

}  // namespace tessera
