// --dry-run of the commands that render.
#pragma once

#include <optional>

#include "client/cancellation.h"
#include "client/dry_run.h"
#include "client/scene_options.h"
#include "renderer/util/result.h"

namespace tessera {

// Prints the forecast of a job on stdout. Returns the exit code.
Result<int> PrintForecast(const SceneOptions& options, int threads, bool json, Cancellation& cancellation,
                          const std::optional<FarmCapacity>& farm = std::nullopt);

}  // namespace tessera
