// Turns exceptions, which only lack of memory and libraries cause, into errors of the task that they occur
// in.
#pragma once

#include <exception>
#include <new>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

inline std::string ReasonOf(const std::exception& e) {
  const bool is_memory = dynamic_cast<const std::bad_alloc*>(&e) != nullptr;
  return is_memory ? "the coordinator is out of memory" : e.what();
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

}  // namespace tessera
