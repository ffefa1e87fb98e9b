// A scene, or the frames of a sequence, made ready to be rendered here or sent to a farm.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "client/coordinator/packed_scene.h"
#include "client/options.h"
#include "client/scene_frames.h"
#include "renderer/scene/scene.h"

namespace tessera {

// Immutable once loaded.
struct SceneJob {
  std::vector<SceneFrame> frames;  // as many as packed.frames
  PackedScene packed;
  std::unique_ptr<Scene> scene;        // of the first frame
  std::shared_ptr<SharedCache> cache;  // of what the frames share
};

// Reads every scene file with all it refers to, on all cores, and says on stderr what they ask for and will
// not get. The error is that of the first frame that has one. Only the first scene is kept, built to `depth`.
// The same scene gives the same frame at either depth, alone or in a sequence: nothing in a picture tells how
// it was rendered. kInterrupted if `stop` was requested first.
Result<SceneJob> LoadSceneJob(const Options& options, Scene::Depth depth, std::stop_token stop);

}  // namespace tessera
