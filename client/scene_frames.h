// The frames that a command line asks for, each with its scene file, and how they are read.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/options.h"
#include "renderer/description/file_source.h"
#include "renderer/scene/scene.h"
#include "renderer/util/shared_cache.h"

namespace tessera {

// What the frames of a sequence share, decoded and parsed: the textures and meshes of some large scenes.
constexpr uint64_t kSharedBytesMax = uint64_t{2} << 30;

struct SceneFrame {
  int number = 0;    // what the user calls it
  std::string path;  // of its scene file
  RenderOptions options;
  // Whether all frames are of one file, in which what moves is shown at the frame's time.
  bool is_animated = false;

  std::string folder() const;
  std::string name() const;  // of the file in its folder
};

// One for a scene without --frames. An error, before any file is read, if a name makes no sense.
Result<std::vector<SceneFrame>> ListFrames(const Options& options);

struct LoadedFrame {
  std::unique_ptr<Scene> scene;
  std::map<std::string, DiskFileSource::File> files;  // by the names that the scene uses
};

// Reads the scene file with all it refers to.
Result<LoadedFrame> LoadFrame(const SceneFrame& frame, Scene::Depth depth,
                              const std::shared_ptr<SharedCache>& cache);

}  // namespace tessera
