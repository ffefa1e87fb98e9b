#include "renderer/scene/probe.h"

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "renderer/film/radiance_tile.h"
#include "renderer/scene/probe_scene.h"
#include "renderer/scene/scene.h"
#include "renderer/util/parallel.h"

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

// The encoded sums of a variant's picture.
Result<std::string> Render(const ProbeVariant& variant, const std::shared_ptr<SharedCache>& cache) {
  ProbeFiles files(SceneText(variant), cache);
  RenderOptions options;
  options.accelerator = variant.accelerator;
  if (variant.has_layers) options.aovs = {"all"};
  const auto scene = Scene::Load(files, "probe.pbrt", options, Scene::Depth::kRender);
  if (!scene) return scene.error();
  const FrameSpec& frame = (*scene)->frame();
  std::string sums;
  for (const SampleRange range : DyadicPartition(frame.samples_per_pixel)) {
    sums += EncodeRadianceTile(*(*scene)->Render(frame.crop, {}, range, nullptr));
  }
  return sums;
}

}  // namespace

Result<Digest> RenderProbe(int threads) {
  const std::span<const ProbeVariant> variants = ProbeVariants();
  const auto cache = std::make_shared<SharedCache>(kCacheBytesMax);
  std::vector<Result<std::string>> pictures(variants.size(), std::string());
  const auto rendered =
      ForEachItem(variants.size(), threads, {}, [&](size_t i) { pictures[i] = Render(variants[i], cache); });
  if (!rendered) return rendered.error();
  std::string sums;
  for (const Result<std::string>& picture : pictures) {
    if (!picture) return picture.error();
    sums += *picture;
  }
  return Sha256(sums);
}

}  // namespace tessera
