#include "client/scene_frames.h"

#include <fmt/format.h>

#include <filesystem>

#include "client/frame_name.h"

namespace tessera {

std::string SceneFrame::folder() const {
  return std::filesystem::path(path).parent_path().string();
}

std::string SceneFrame::name() const {
  return std::filesystem::path(path).filename().string();
}

Result<std::vector<SceneFrame>> ListFrames(const SceneOptions& options) {
  const FrameName name(options.path);
  if (std::filesystem::path(options.path).filename().empty())
    return BadInput(fmt::format("{}: not a scene file", options.path));
  if (!options.frames) {
    std::error_code error;
    if (name.HasPlace() && !std::filesystem::exists(options.path, error)) {
      return BadInput(fmt::format(
          "{}: no such file; to render a sequence, add --frames A-B to choose its frames", options.path));
    }
    return std::vector<SceneFrame>{{0, options.path, options.render, false}};
  }
  const bool is_animated = !name.HasPlace();
  std::vector<SceneFrame> frames;
  for (const int number : options.frames->Numbers()) {
    SceneFrame frame{number, name.Of(number), options.render, is_animated};
    if (is_animated) frame.options.time = number / options.fps;
    frames.push_back(std::move(frame));
  }
  return frames;
}

Result<LoadedFrame> LoadFrame(const SceneFrame& frame, Scene::Depth depth,
                              const std::shared_ptr<SharedCache>& cache) {
  DiskFileSource files(frame.folder(), cache);
  auto scene = Scene::Load(files, frame.name(), frame.options, depth);
  if (!scene) return scene.error();
  return LoadedFrame{std::move(*scene), files.FilesRead()};
}

}  // namespace tessera
