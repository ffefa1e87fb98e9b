// Work that is split into independent items.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>

#include "renderer/util/result.h"

namespace tessera {

// Calls body(i) once for each i below `count`, on up to `threads` threads, the caller's among them. Items are
// started in order. If the system does not start a thread, the others do its work. Returns the first error
// of a body that threw, such as std::bad_alloc, or kInterrupted if a stop was requested before all items were
// done; no items are started after either.
Result<void> ForEachItem(size_t count, int threads, const std::stop_token& stop,
                         const std::function<void(size_t)>& body);

}  // namespace tessera
