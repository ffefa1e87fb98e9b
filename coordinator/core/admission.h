// Which workers may join a farm.
#pragma once

#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

// The worker must be of this release and compute the same pictures. The error says what differs and what to
// do.
Result<void> CheckRelease(const WorkerState& state);

}  // namespace tessera
