#include "worker/scene_loader.h"

#include <fmt/format.h>

#include <atomic>
#include <exception>
#include <new>

#include "proto/package_names.h"
#include "renderer/scene/version.h"

namespace tessera {
namespace {

// Whether a frame was ordered by this release, or by an earlier one whose job is continued: that names itself
// in the header, and lacks attributes that were added later.
bool IsFrameOf(FrameSpec read, const FrameSpec& ordered) {
  std::erase_if(read.attributes, [&](const auto& attribute) {
    return attribute.first != kSceneDigestAttribute && !ordered.attributes.contains(attribute.first);
  });
  for (const char* const name : {kSoftwareAttribute, kVersionAttribute}) {
    if (const auto stated = ordered.attributes.find(name); stated != ordered.attributes.end())
      read.attributes[name] = stated->second;
  }
  return read == ordered;
}

}  // namespace

const PackageFile* PackageFileSource::Find(const std::string& name) {
  std::string path = PackagePath(name);
  auto file = package_.files.find(folder_ + path);
  if (path.empty() || file == package_.files.end()) return nullptr;
  const std::lock_guard lock(mutex_);
  read_.files.emplace(std::move(path), file->second);
  return &file->second;
}

Result<std::string> PackageFileSource::Read(const std::string& name) {
  const PackageFile* const file = Find(name);
  if (file == nullptr) return BadInput(fmt::format("{}: is not in the scene package", name));
  auto bytes = fetch_(file->digest, file->size);
  if (!bytes) return Error{bytes.error().kind, fmt::format("{}: {}", name, bytes.error().message)};
  if (bytes->size() != file->size)
    return Failed(fmt::format("{}: its size differs from the one in the manifest", name));
  return bytes;
}

std::optional<Digest> PackageFileSource::Identify(const std::string& name) {
  const PackageFile* const file = Find(name);
  return file != nullptr ? std::optional(file->digest) : std::nullopt;
}

ScenePackage PackageFileSource::PackageRead() const {
  const std::lock_guard lock(mutex_);
  return read_;
}

Result<std::shared_ptr<const Scene>> LoadOrderedScene(const SceneRequest& order, const FetchBlob& fetch,
                                                      std::shared_ptr<SharedCache> cache) {
  const auto options = DecodeRenderOptions(order.options);
  if (!options) return options.error();
  const auto manifest = fetch(order.package, kManifestBytesMax);
  if (!manifest) return manifest.error();
  auto package = DecodeScenePackage(*manifest);
  if (!package) return package.error();
  const std::string folder = PackageFolder(order.scene_file);
  const std::string name = NameOfPackagePath(order.scene_file.substr(folder.size()));
  PackageFileSource files(std::move(*package), folder, fetch, std::move(cache));
  auto scene = Scene::Load(files, name, *options, Scene::Depth::kRender);
  if (!scene) return scene.error();
  FrameSpec frame = (*scene)->frame();
  frame.attributes[kSceneDigestAttribute] = Sha256(EncodeScenePackage(files.PackageRead())).Hex();
  if (!IsFrameOf(std::move(frame), order.frame)) {
    return Failed(fmt::format(
        "{}: the frame that this worker reads from the scene differs from the one submitted", name));
  }
  return std::shared_ptr<const Scene>(std::move(*scene));
}

LoadOutcome LoadOrderedScene(const SceneRequest& order, const LoadLimits& limits, const FetchBlob& fetch,
                             std::shared_ptr<SharedCache> cache) {
  std::atomic<bool> is_out_of_reach = false;
  const FetchBlob watched_fetch = [&](const Digest& digest, uint64_t size_max) {
    auto bytes = fetch(digest, size_max);
    // Bad input: the coordinator has no such file, whoever asks.
    if (!bytes && bytes.error().kind != ErrorKind::kBadInput) is_out_of_reach = true;
    return bytes;
  };
  std::optional<Result<std::shared_ptr<const Scene>>> loaded;
  const auto within = RunWithinLimits(order.scene_file, limits, [&] {
    try {
      loaded.emplace(LoadOrderedScene(order, watched_fetch, std::move(cache)));
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      loaded.emplace(Failed(fmt::format("{}: {}", order.scene_file, e.what())));
    }
  });
  if (!within) return {nullptr, within.error().message, FailureCause::kWorkerLimit};
  if (*loaded) return {std::move(**loaded), "", FailureCause::kScene};
  return {nullptr, loaded->error().message,
          is_out_of_reach ? FailureCause::kWorkerLimit : FailureCause::kScene};
}

}  // namespace tessera
