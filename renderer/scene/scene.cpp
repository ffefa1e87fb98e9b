#include "renderer/scene/scene.h"

#include <fmt/format.h>

#include <chrono>

#include "renderer/pbrt/parser.h"
#include "renderer/scene/scene_builder.h"
#include "renderer/scene/scene_data.h"
#include "renderer/util/seconds_since.h"

namespace tessera {
namespace {

Result<void> CheckOptions(const RenderOptions& options) {
  if (options.samples_per_pixel &&
      (*options.samples_per_pixel < 1 || *options.samples_per_pixel > kSamplesPerPixelMax)) {
    return BadInput("--spp: must lie between 1 and " + std::to_string(kSamplesPerPixelMax));
  }
  if (options.tile_size && (*options.tile_size < 1 || *options.tile_size > kTileSizeMax)) {
    return BadInput("--tile-size: must lie between 1 and " + std::to_string(kTileSizeMax));
  }
  if (!(options.noise_threshold >= 0 && options.noise_threshold <= kNoiseThresholdMax))
    return BadInput(fmt::format("--noise-threshold: must lie between 0 and {}", kNoiseThresholdMax));
  if (options.cryptomatte_levels &&
      (*options.cryptomatte_levels < 1 || *options.cryptomatte_levels > kCryptomatteLevelsMax))
    return BadInput(fmt::format("--cryptomatte-levels: must lie between 1 and {}", kCryptomatteLevelsMax));
  return {};
}

}  // namespace

Scene::Scene(std::unique_ptr<Data> data) : data_(std::move(data)) {}
Scene::~Scene() = default;
const FrameSpec& Scene::frame() const {
  return data_->frame;
}
void Scene::SetFrameAttributes(const RenderOptions& options,
                               std::map<std::string, std::string>& attributes) const {
  data_->frame_attributes.Set(options, attributes);
}
const SceneSummary& Scene::summary() const {
  return data_->summary;
}

Result<std::unique_ptr<Scene>> Scene::Load(FileSource& files, const std::string& name,
                                           const RenderOptions& options, Depth depth) {
  const auto start = std::chrono::steady_clock::now();
  Result<SceneDescription> description = ParseScene(files, name);
  if (!description) return description.error();
  const double seconds = SecondsSince(start);
  Result<std::unique_ptr<Scene>> scene = Build(*std::move(description), files, name, options, depth);
  if (scene) (*scene)->data_->summary.load_seconds += seconds;
  return scene;
}

Result<std::unique_ptr<Scene>> Scene::Build(SceneDescription description, FileSource& files,
                                            const std::string& name, const RenderOptions& options,
                                            Depth depth) {
  if (Result<void> checked = CheckOptions(options); !checked) return checked.error();
  Result<std::unique_ptr<Data>> data =
      SceneBuilder(std::move(description), files, options).Build(name, depth);
  if (!data) return data.error();
  return std::unique_ptr<Scene>(new Scene(std::move(*data)));
}

}  // namespace tessera
