// Brings results and failures back to the coordinator.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>

#include "proto/terms.h"
#include "renderer/util/result.h"
#include "worker/workbench.h"

namespace grpc {
class Channel;
}

namespace tessera {

// While one call is on its way new results gather for the next, so a fast worker sends fewer, larger calls,
// and no slot ever waits for one. Belongs to the thread that runs it.
class Returner {
 public:
  Returner(std::shared_ptr<grpc::Channel> channel, WorkerId worker, Workbench& bench,
           std::function<void(Error)> on_refusal)
      : channel_(std::move(channel)), worker_(worker), bench_(bench), on_refusal_(std::move(on_refusal)) {}
  // Returns what the workbench has, again and again until it is answered, until a stop is requested.
  void Run(std::stop_token stop);

 private:
  std::shared_ptr<grpc::Channel> channel_;
  WorkerId worker_;
  Workbench& bench_;
  const std::function<void(Error)> on_refusal_;
};

}  // namespace tessera
