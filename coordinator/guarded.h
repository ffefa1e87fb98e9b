// Turns exceptions, which only lack of memory and libraries cause, into errors of the call that they occur
// in. What nobody catches ends the program with a message (proto/shell/program.h).
#pragma once

#include <grpcpp/support/status.h>

#include "coordinator/core/guarded_result.h"

namespace tessera {

// What `task` returns, which is a grpc::Status.
template <typename Task>
grpc::Status GuardedStatus(Task task) {
  try {
    return task();
  } catch (const std::exception& e) {
    return {grpc::StatusCode::RESOURCE_EXHAUSTED, ReasonOf(e)};
  }
}

}  // namespace tessera
