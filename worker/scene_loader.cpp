#include "worker/scene_loader.h"

#include <fmt/format.h>

#include "terms/package_names.h"

namespace tessera {

Result<std::string> PackageFileSource::Read(const std::string& name) {
  auto file = package_.files.find(PackagePath(name));
  if (file == package_.files.end())
    file = package_.files.find(name);  // the scene file itself goes by its path
  if (file == package_.files.end()) return BadInput(fmt::format("{}: is not in the scene's package", name));
  auto bytes = fetch_(file->second.digest, file->second.size);
  if (!bytes) return Error{bytes.error().kind, fmt::format("{}: {}", name, bytes.error().message)};
  if (bytes->size() != file->second.size)
    return Failed(fmt::format("{}: its size is not the manifest's", name));
  return bytes;
}

Result<std::shared_ptr<const Scene>> LoadOrderedScene(const SceneOrder& order, const FetchBlob& fetch) {
  const auto options = DecodeRenderOptions(order.options);
  if (!options) return options.error();
  const auto manifest = fetch(order.package, kManifestBytesMax);
  if (!manifest) return manifest.error();
  auto package = DecodeScenePackage(*manifest);
  if (!package) return package.error();
  PackageFileSource files(std::move(*package), fetch);
  auto scene = Scene::Load(files, order.scene_file, *options, Scene::Depth::kRender);
  if (!scene) return scene.error();
  FrameSpec frame = (*scene)->frame();
  frame.attributes[kSceneDigestAttribute] = order.package.Hex();
  if (frame != order.frame) {
    return Failed(fmt::format("{}: this worker reads another frame from the scene than the one ordered",
                              order.scene_file));
  }
  return std::shared_ptr<const Scene>(std::move(*scene));
}

}  // namespace tessera
