#include "renderer/scene/probe.h"

#include <map>
#include <memory>
#include <string>

#include "renderer/film/radiance_tile.h"
#include "renderer/scene/probe_scene.h"
#include "renderer/scene/scene.h"

namespace tessera {
namespace {

// For what takes longest to compute and is the same in all scenes of the probe.
constexpr uint64_t kCacheBytesMax = uint64_t{1} << 20;

class ProbeFiles : public FileSource {
 public:
  ProbeFiles(std::string scene, std::shared_ptr<SharedCache> cache)
      : FileSource(std::move(cache)), scene_(std::move(scene)) {}
  Result<std::string> Read(const std::string& name) override {
    if (name == "probe.pbrt") return scene_;
    if (name == "probe.ply") return std::string(kProbeMesh);
    if (name == "probe.pfm") return ProbeImage();
    if (name == "probe.ies") return std::string(kProbeLuminaire);
    if (name == "probe.lens") return std::string(kProbeLens);
    return BadInput(name + ": is not a file of the probe");
  }

 private:
  std::string scene_;
};

std::string SceneText(const ProbeVariant& variant) {
  std::string text = std::string(kProbeHead) + variant.settings + kProbeWorld;
  if (variant.has_lights_of_no_size) text += kProbeLightsOfNoSize;
  if (variant.has_layers) text += kProbeVisibility;
  return text;
}

}  // namespace

Result<Digest> RenderProbe() {
  std::string sums;
  const auto cache = std::make_shared<SharedCache>(kCacheBytesMax);
  for (const ProbeVariant& variant : ProbeVariants()) {
    ProbeFiles files(SceneText(variant), cache);
    RenderOptions options;
    options.accelerator = variant.accelerator;
    if (variant.has_layers) options.aovs = {"all"};
    const auto scene = Scene::Load(files, "probe.pbrt", options, Scene::Depth::kRender);
    if (!scene) return scene.error();
    const FrameSpec& frame = (*scene)->frame();
    for (const SampleRange range : DyadicPartition(frame.samples_per_pixel)) {
      sums += EncodeRadianceTile(*(*scene)->Render(frame.crop, {}, range, nullptr));
    }
  }
  return Sha256(sums);
}

}  // namespace tessera
