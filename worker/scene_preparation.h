// From a scene that was ordered to the frames of its job.
#pragma once

#include <memory>

#include "proto/terms.h"
#include "renderer/util/result.h"
#include "worker/scene_loader.h"

namespace tessera {

// Reads every frame, each with its scene file, as `tessera submit` does, and makes the same frames. An error,
// for the user to read, if a file cannot be fetched or a scene is invalid: that of the first frame that has
// one. Reuses what `cache`, which may be null, holds of the same files.
Result<PreparationReport> PrepareScene(const PreparationRequest& request, const FetchBlob& fetch,
                                       const std::shared_ptr<SharedCache>& cache = nullptr);

}  // namespace tessera
