#include "client/scene_frames.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>

#include "proto/frame_name.h"
#include "renderer/pbrt/parser.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr const char* kStandardInput = "-";            // as users write it
constexpr const char* kStandardInputName = "<stdin>";  // in messages and packages
constexpr int kStopProbe_ms = 100;

// Finds the end of what the parser looks at: a zero byte outside of comments, which it refuses, whatever
// follows.
class RefusedByte {
 public:
  // The position of the byte in the next piece of text, or that of its end if there is none.
  size_t FindIn(std::string_view piece) {
    for (size_t i = 0; i < piece.size(); ++i) {
      if (piece[i] == '\0' && !has_comment_) return i;
      if (piece[i] == '#') has_comment_ = true;  // or a string holds it: then the rest is read, and refused
      if (piece[i] == '\n') has_comment_ = false;
    }
    return piece.size();
  }

 private:
  bool has_comment_ = false;  // the current line
};

// Reads a scene to its end, or to the first byte that makes it none: a device has no end.
Result<std::string> ReadAll(int descriptor, std::stop_token stop) {
  std::string bytes;
  RefusedByte refused;
  char piece[1 << 16];
  while (true) {
    if (stop.stop_requested()) return Error{ErrorKind::kInterrupted, "interrupted"};
    pollfd event{descriptor, POLLIN, 0};
    if (::poll(&event, 1, kStopProbe_ms) == 0) continue;
    const ssize_t got = ::read(descriptor, piece, sizeof piece);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return BadInput(fmt::format("standard input cannot be read: {}", std::strerror(errno)));
    if (got == 0) return bytes;
    const std::string_view read(piece, static_cast<size_t>(got));
    bytes += read;
    if (!IsGzip(bytes)) {
      const size_t end = refused.FindIn(read);
      if (end < read.size()) {
        bytes.resize(bytes.size() - read.size() + end + 1);
        return bytes;
      }
    }
    if (bytes.size() > kSceneFileSizeMax)
      return BadInput(fmt::format("standard input holds more than the limit of {} bytes", kSceneFileSizeMax));
  }
}

// Loads a scene that is not in a file. A worker reads its bytes under its name.
Result<LoadedFrame> LoadText(const SceneFrame& frame, Scene::Depth depth, DiskFileSource& files) {
  auto text = IsGzip(*frame.text) ? Gunzip(*frame.text, frame.name(), kSceneFileSizeMax)
                                  : Result<std::string>(*frame.text);
  if (!text) return text.error();
  auto description = ParseSceneText(files, frame.name(), std::move(*text));
  if (!description) return description.error();
  auto scene = Scene::Build(std::move(*description), files, frame.name(), frame.options, depth);
  if (!scene) return scene.error();
  LoadedFrame loaded{std::move(*scene), files.FilesRead()};
  loaded.files[frame.name()] = {"", Sha256(*frame.text), frame.text->size()};
  return loaded;
}

Result<LoadedFrame> ReadUnbounded(const SceneFrame& frame, Scene::Depth depth,
                                  const std::shared_ptr<SharedCache>& cache) {
  DiskFileSource files(frame.folder(), cache);
  if (frame.text != nullptr) return LoadText(frame, depth, files);
  // Only files that a scene refers to are searched for. The scene itself is the file that the user named.
  if (::access(frame.path.c_str(), R_OK) != 0)
    return BadInput(fmt::format("{}: cannot be opened: {}", frame.path, std::strerror(errno)));
  auto scene = Scene::Load(files, frame.name(), frame.options, depth);
  if (!scene) return scene.error();
  return LoadedFrame{std::move(*scene), files.FilesRead()};
}

}  // namespace

bool IsStandardInput(const SceneOptions& options) {
  return options.path == kStandardInput;
}

std::string SceneName(const SceneOptions& options) {
  if (IsStandardInput(options)) return "stdin";
  std::filesystem::path name = std::filesystem::path(options.path).filename();
  if (name.extension() == ".gz" || name.extension() == ".GZ") name.replace_extension();
  return name.replace_extension().string();
}

Result<void> ReadStandardInput(std::vector<SceneFrame>& frames, std::stop_token stop) {
  auto bytes = ReadAll(STDIN_FILENO, stop);
  if (!bytes) return bytes.error();
  const auto text = std::make_shared<const std::string>(std::move(*bytes));
  for (SceneFrame& frame : frames) {
    frame.path = kStandardInputName;
    frame.text = text;
  }
  return {};
}

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
  }
  std::vector<SceneFrame> frames;
  for (SequenceFrame& frame : FramesOf(options.path, options.render, options.frames, options.fps))
    frames.push_back({std::move(frame), nullptr, options.scene_memory});
  return frames;
}

LoadLimits LimitsOf(const SceneFrame& frame) {
  constexpr std::chrono::seconds kAnyTime = std::chrono::years(1);
  if (frame.memory) return {*frame.memory, kAnyTime};
  return {UsableMemory(), kAnyTime, "all of this machine or its control group"};
}

Result<LoadedFrame> LoadFrame(const SceneFrame& frame, Scene::Depth depth,
                              const std::shared_ptr<SharedCache>& cache) {
  return LoadWithinLimits(frame.path, LimitsOf(frame), [&] { return ReadUnbounded(frame, depth, cache); });
}

}  // namespace tessera
