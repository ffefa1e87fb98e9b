// What the result of a unit must be, from the specification of its job alone: results are decoded by threads
// that do not own the farm.
#pragma once

#include "proto/terms.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/util/result.h"

namespace tessera {

// An error if the job has no such frame or tile.
Result<TileRequest> RequestOf(const JobSpec& job, const WorkUnit& unit);

}  // namespace tessera
