// The frames that a command renders, each with its scene file, and how they are read.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/scene_options.h"
#include "renderer/description/file_source.h"
#include "renderer/scene/scene.h"
#include "renderer/util/shared_cache.h"

namespace tessera {

// What the frames of a sequence share, decoded and parsed: the textures and meshes of some large scenes.
constexpr uint64_t kSharedBytesMax = uint64_t{2} << 30;

struct SceneFrame {
  int number = 0;    // as the user counts
  std::string path;  // of its scene file
  RenderOptions options;
  // All frames come from one scene file, whose moving parts are shown at the time of the frame.
  bool is_animated = false;

  std::string folder() const;
  std::string name() const;  // of the file in its folder
};

// The frames of a sequence, or the one frame of a scene without --frames. Fails before any file is read if
// the options do not name scene files.
Result<std::vector<SceneFrame>> ListFrames(const SceneOptions& options);

struct LoadedFrame {
  std::unique_ptr<Scene> scene;
  std::map<std::string, DiskFileSource::File> files;  // by the names that the scene uses
};

// Reads the scene file and all files it refers to.
Result<LoadedFrame> LoadFrame(const SceneFrame& frame, Scene::Depth depth,
                              const std::shared_ptr<SharedCache>& cache);

}  // namespace tessera
