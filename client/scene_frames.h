// The frames that a command renders, each with its scene file, and how they are read.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/scene_options.h"
#include "proto/sequence/sequence_frames.h"
#include "renderer/description/file_source.h"
#include "renderer/load/limited_load.h"
#include "renderer/scene/scene.h"
#include "renderer/util/shared_cache.h"

namespace tessera {

// What the frames of a sequence share, decoded and parsed: the textures and meshes of some large scenes.
constexpr uint64_t kSharedBytesMax = uint64_t{2} << 30;

struct SceneFrame : SequenceFrame {
  // If not null, what is read instead of the file: the scene came from standard input.
  std::shared_ptr<const std::string> text = nullptr;
  std::optional<uint64_t> memory = std::nullopt;  // SceneOptions::scene_memory

  std::string folder() const;
  std::string name() const;  // of the file in its folder
};

// Whether the scene is read from standard input.
bool IsStandardInput(const SceneOptions& options);

// The name of the scene without its folder and extensions: "box" of "shots/box.pbrt.gz", "stdin" of "-".
std::string SceneName(const SceneOptions& options);

// The frames of a sequence, or the one frame of a scene without --frames. Fails before any file is read if
// the options do not name scene files.
Result<std::vector<SceneFrame>> ListFrames(const SceneOptions& options);

// Reads standard input to its end and makes it the scene file of the frames, which may be compressed by gzip.
// Returns kInterrupted if a stop is requested first.
Result<void> ReadStandardInput(std::vector<SceneFrame>& frames, std::stop_token stop);

struct LoadedFrame {
  std::unique_ptr<Scene> scene;
  std::map<std::string, DiskFileSource::File> files;  // by the names that the scene uses
};

// Of memory, by default all that the machine or the control group has. Of time, any: the user can interrupt.
LoadLimits LimitsOf(const SceneFrame& frame);

// Reads the scene file and all files it refers to, within LimitsOf.
Result<LoadedFrame> LoadFrame(const SceneFrame& frame, Scene::Depth depth,
                              const std::shared_ptr<SharedCache>& cache);

}  // namespace tessera
