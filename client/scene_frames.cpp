#include "client/scene_frames.h"

#include <fmt/format.h>

#include <filesystem>

#include "client/frame_names.h"

namespace tessera {
namespace {

Error NoFrameNumbers(const std::string& path) {
  return BadInput(fmt::format(
      "{}: there is no such file; if it stands for the files of a sequence, say which frames of it with "
      "--frames A-B",
      path));
}

}  // namespace

std::string SceneFrame::folder() const {
  return std::filesystem::path(path).parent_path().string();
}

std::string SceneFrame::name() const {
  return std::filesystem::path(path).filename().string();
}

Result<std::vector<SceneFrame>> ListFrames(const Options& options) {
  const std::string& path = options.scene;
  if (std::filesystem::path(path).filename().empty())
    return BadInput(fmt::format("{}: is not a scene file", path));
  const bool is_pattern = IsFramePattern(path);
  if (!options.frames) {
    std::error_code error;
    if (is_pattern && !std::filesystem::exists(path, error)) return NoFrameNumbers(path);
    return std::vector<SceneFrame>{{0, path, options.render, false}};
  }
  std::vector<SceneFrame> frames;
  for (const int number : options.frames->Numbers()) {
    SceneFrame frame{number, is_pattern ? NameOfFrame(path, number) : path, options.render, !is_pattern};
    if (!is_pattern) frame.options.time = number / options.fps;
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
