#include "client/scene_job.h"

#include <fmt/format.h>

#include <filesystem>

#include "terms/package_names.h"

namespace tessera {
namespace {

void PrintWarnings(const SceneSummary& summary) {
  for (const std::string& warning : summary.warnings) fmt::print(stderr, "tessera: warning: {}\n", warning);
}

Result<void> Pack(const std::map<std::string, DiskFileSource::File>& files, PackedScene& packed) {
  if (files.size() > kFilesPerPackageMax) {
    return BadInput(
        fmt::format("the scene refers to {} files, more than {}", files.size(), kFilesPerPackageMax));
  }
  for (const auto& [name, file] : files) {
    const std::string path = PackagePath(name);
    if (path.empty())
      return BadInput(fmt::format("{}: the file's name is too long to be sent to a farm", name));
    packed.package.files[path] = {file.digest, file.size};
    packed.disk_paths.emplace(file.digest, file.path);
  }
  packed.manifest = EncodeScenePackage(packed.package);
  packed.digest = Sha256(packed.manifest);
  return {};
}

}  // namespace

Result<SceneJob> LoadSceneJob(const Options& options, Scene::Depth depth) {
  const std::filesystem::path path(options.scene);
  const std::string name = path.filename().string();
  if (name.empty()) return BadInput(fmt::format("{}: is not a scene file", options.scene));
  DiskFileSource files(path.parent_path().string());
  auto scene = Scene::Load(files, name, options.render, depth);
  if (!scene) return scene.error();
  PrintWarnings((*scene)->summary());
  SceneJob job;
  job.scene = std::move(*scene);
  if (auto packed = Pack(files.FilesRead(), job.packed); !packed) return packed.error();
  job.packed.frame.scene_file = PackagePath(name);
  job.packed.frame.options = EncodeRenderOptions(options.render);
  job.packed.frame.spec = job.scene->frame();
  job.packed.frame.extendable = job.scene->summary().extendable;
  job.packed.frame.spec.attributes[kSceneDigestAttribute] = job.packed.digest.Hex();
  return job;
}

}  // namespace tessera
