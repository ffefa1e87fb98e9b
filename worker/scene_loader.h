// From a scene order to a scene ready to render.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "scene/scene.h"
#include "terms/scene_package.h"
#include "terms/terms.h"
#include "util/result.h"

namespace tessera {

// Gives the bytes that have the digest, from wherever they are; an error if they cannot be had or are more
// than `size_max`. Called from any thread.
using FetchBlob = std::function<Result<std::string>(const Digest& digest, uint64_t size_max)>;

// The files of one package, read as the scene calls them. What the manifest does not name does not exist, so
// a scene reaches nothing else on this machine. Thread safe.
class PackageFileSource : public FileSource {
 public:
  PackageFileSource(ScenePackage package, FetchBlob fetch)
      : package_(std::move(package)), fetch_(std::move(fetch)) {}
  Result<std::string> Read(const std::string& name) override;

 private:
  const ScenePackage package_;
  const FetchBlob fetch_;
};

// Fetches, parses and builds. An error, in words for the user, if a file cannot be had, the scene is bad, or
// its frame is not the one that was ordered.
Result<std::shared_ptr<const Scene>> LoadOrderedScene(const SceneOrder& order, const FetchBlob& fetch);

}  // namespace tessera
