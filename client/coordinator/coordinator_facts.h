// What a coordinator tells about itself, for `tessera doctor`.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "proto/terms.h"
#include "proto/wire/endpoint.h"
#include "renderer/util/result.h"

namespace tessera {

struct CoordinatorFacts {
  std::string software_version;
  uint32_t protocol = 0;
  bool has_clock = false;    // older coordinators do not tell the time
  double clock_ahead_s = 0;  // of that of this machine
  double answer_s = 0;       // that the answer took: the clocks may differ by half of it less or more
  std::optional<std::vector<WorkerStatus>> workers;  // if this member may list them
};

// Accepts any version. Fails if the coordinator does not answer within seconds or does not admit us.
Result<CoordinatorFacts> AskForFacts(const Endpoint& endpoint, std::stop_token stop);

}  // namespace tessera
