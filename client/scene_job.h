// A scene, or the frames of a sequence, ready to be rendered here or sent to a farm.
#pragma once

#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "client/coordinator/packed_scene.h"
#include "client/scene_frames.h"
#include "renderer/scene/scene.h"

namespace tessera {

// Immutable once loaded.
struct SceneJob {
  std::vector<SceneFrame> frames;  // one for each of packed.frames
  PackedScene packed;
  std::set<std::string> input_paths;   // of all files that the frames consist of
  std::unique_ptr<Scene> scene;        // of the first frame
  std::shared_ptr<SharedCache> cache;  // of what the frames share
};

// Reads every scene file and the files it refers to, on all cores, and prints their warnings on stderr.
// Returns the error of the first frame that has one. Only the first scene is kept, built to `depth`. The same
// scene gives the same frame at any depth, alone or in a sequence, so that a picture does not depend on how
// it was rendered. Returns kInterrupted if a stop is requested first.
Result<SceneJob> LoadSceneJob(const SceneOptions& options, Scene::Depth depth, std::stop_token stop);

}  // namespace tessera
