// Sends results and failures to the coordinator.
#pragma once

#include <memory>
#include <stop_token>

#include "proto/terms.h"
#include "worker/shared_workload.h"

namespace grpc {
class Channel;
}

namespace tessera {

// While one call is under way, results gather for the next, so that a fast worker makes fewer and larger
// calls and no slot waits for one. Belongs to the thread that calls Run.
class ResultSender {
 public:
  ResultSender(std::shared_ptr<grpc::Channel> channel, WorkerId worker, SharedWorkload& workload)
      : channel_(std::move(channel)), worker_(worker), workload_(workload) {}
  // Sends what the workload has until a stop is requested, each batch until it is acknowledged or can never
  // be. A batch that the coordinator refuses does not delay those after it.
  void Run(std::stop_token stop);

 private:
  std::shared_ptr<grpc::Channel> channel_;
  WorkerId worker_;
  SharedWorkload& workload_;
};

}  // namespace tessera
