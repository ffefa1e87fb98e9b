// Sends results and failures to the coordinator.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>

#include "proto/terms.h"
#include "renderer/util/result.h"
#include "worker/shared_workload.h"

namespace grpc {
class Channel;
}

namespace tessera {

// While one call is under way, results gather for the next, so that a fast worker makes fewer and larger
// calls and no slot waits for one. Belongs to the thread that calls Run.
class ResultSender {
 public:
  ResultSender(std::shared_ptr<grpc::Channel> channel, WorkerId worker, SharedWorkload& workload,
               std::function<void(Error)> on_refusal)
      : channel_(std::move(channel)),
        worker_(worker),
        workload_(workload),
        on_refusal_(std::move(on_refusal)) {}
  // Sends what the workload has, each batch until it is acknowledged. Returns when a stop is requested, or
  // when the coordinator does not admit this worker any more.
  void Run(std::stop_token stop);

 private:
  std::shared_ptr<grpc::Channel> channel_;
  WorkerId worker_;
  SharedWorkload& workload_;
  const std::function<void(Error)> on_refusal_;
};

}  // namespace tessera
