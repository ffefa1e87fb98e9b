#include "worker/scene_preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "proto/package_names.h"
#include "proto/sequence/sequence_frames.h"

namespace tessera {
namespace {

// Each warning once, however many frames have it.
void AddWarnings(const std::vector<std::string>& warnings, PreparationReport& report) {
  for (const std::string& warning : warnings) {
    const bool is_known = std::ranges::find(report.warnings, warning) != report.warnings.end();
    if (!is_known && report.warnings.size() < static_cast<size_t>(kPreparationWarningsMax))
      report.warnings.push_back(warning);
  }
}

}  // namespace

Result<PreparationReport> PrepareScene(const PreparationRequest& request, const FetchBlob& fetch,
                                       const std::shared_ptr<SharedCache>& cache) {
  const SceneOrder& order = request.scene;
  const auto options = DecodeRenderOptions(order.options);
  if (!options) return options.error();
  const auto manifest = fetch(order.package, kManifestBytesMax);
  if (!manifest) return manifest.error();
  const auto package = DecodeScenePackage(*manifest);
  if (!package) return package.error();
  const auto frames = FramesOf(order.scene_file, *options, order.frames, order.frames_per_second);
  PreparationReport report;
  report.key = request.key;
  const bool is_animated = frames.front().is_animated;
  for (const SequenceFrame& frame : frames) {
    const std::string folder = PackageFolder(frame.path);
    const std::string name = NameOfPackagePath(frame.path.substr(folder.size()));
    PackageFileSource files(*package, folder, fetch, cache);
    const auto scene = Scene::Load(files, name, frame.options, Scene::Depth::kCheck);
    if (!scene) return scene.error();
    auto made = RequestFrame(frame, frame.path, **scene, files.PackageRead());
    if (!made) return made.error();
    report.frames.push_back(std::move(*made));
    AddWarnings((*scene)->summary().warnings, report);
    if (!is_animated) continue;
    if (frames.size() > 1 && (*scene)->summary().moving == 0)
      AddWarnings({fmt::format("{}: nothing in the scene moves, so all {} frames will look the same", name,
                               frames.size())},
                  report);
    for (size_t i = 1; i < frames.size(); ++i)
      report.frames.push_back(RequestFrameLike(report.frames.front(), frames[i], **scene));
    break;
  }
  return report;
}

}  // namespace tessera
