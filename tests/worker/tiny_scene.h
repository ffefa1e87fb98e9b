// The smallest scene that renders, with its order and package as a coordinator would send them.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "proto/package_names.h"
#include "worker/scene_loader.h"

namespace tessera {

inline constexpr const char* kTinyScene =
    "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
    "Sampler \"independent\" \"integer pixelsamples\" 4\n"
    "LookAt 0 0 -3  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nShape "
    "\"sphere\"\n";

// Blobs by digest.
class BlobMap {
 public:
  Digest Add(const std::string& bytes) {
    const Digest digest = Sha256(bytes);
    blobs_[digest] = bytes;
    return digest;
  }
  FetchBlob Fetcher() const {
    return [this](const Digest& digest, uint64_t) -> Result<std::string> {
      const auto blob = blobs_.find(digest);
      if (blob == blobs_.end()) return Failed("no such blob");
      return blob->second;
    };
  }

 private:
  std::map<Digest, std::string> blobs_;
};

// An order for a package that holds `scene` as "scene.pbrt".
inline SceneRequest MakeOrder(BlobMap& blobs, const std::string& scene, const RenderOptions& options = {}) {
  ScenePackage package;
  package.files["scene.pbrt"] = {blobs.Add(scene), scene.size()};
  SceneRequest order;
  order.package = blobs.Add(EncodeScenePackage(package));
  order.scene_file = "scene.pbrt";
  order.options = EncodeRenderOptions(options);
  PackageFileSource files(package, "", blobs.Fetcher());
  const auto loaded = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kCheck);
  if (loaded) order.frame = (*loaded)->frame();
  order.frame.attributes[kSceneDigestAttribute] = order.package.Hex();
  order.key = SceneKey(order.package, order.scene_file, order.options, order.frame);
  return order;
}

inline std::shared_ptr<const Scene> LoadTinyScene() {
  BlobMap blobs;
  return *LoadOrderedScene(MakeOrder(blobs, kTinyScene), blobs.Fetcher());
}

}  // namespace tessera
