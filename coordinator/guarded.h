// Turns exceptions, which only lack of memory and libraries cause, into errors of the call that they occur
// in. What nobody catches ends the program with a message (proto/shell/program.h).
#pragma once

#include <grpcpp/support/status.h>

#include <exception>
#include <new>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

inline std::string ReasonOf(const std::exception& e) {
  const bool is_memory = dynamic_cast<const std::bad_alloc*>(&e) != nullptr;
  return is_memory ? "the coordinator has not enough memory for it" : e.what();
}

// What `task` returns, which is a Result.
template <typename Task>
auto GuardedResult(Task task) -> decltype(task()) {
  try {
    return task();
  } catch (const std::exception& e) {
    return Failed(ReasonOf(e));
  }
}

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
