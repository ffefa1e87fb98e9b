// From a scene order to a scene ready to render.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "proto/scene_package.h"
#include "proto/terms.h"
#include "renderer/scene/scene.h"
#include "renderer/util/result.h"

namespace tessera {

// Gives the bytes that have the digest, from wherever they are; an error if they cannot be had or are more
// than `size_max`. Called from any thread.
using FetchBlob = std::function<Result<std::string>(const Digest& digest, uint64_t size_max)>;

// The files of one scene in a package, read as the scene calls them. What the manifest does not name does not
// exist, so a scene reaches nothing else on this machine. Thread safe.
class PackageFileSource : public FileSource {
 public:
  // `folder` of the package holds the scene's files (PackageFolder).
  PackageFileSource(ScenePackage package, std::string folder, FetchBlob fetch,
                    std::shared_ptr<SharedCache> cache = nullptr)
      : FileSource(std::move(cache)),
        package_(std::move(package)),
        folder_(std::move(folder)),
        fetch_(std::move(fetch)) {}
  Result<std::string> Read(const std::string& name) override;
  // Of what has been read: the package that this scene alone would have.
  ScenePackage PackageRead() const;

 protected:
  std::optional<Digest> Identify(const std::string& name) override;

 private:
  // Null if there is none of that name. It counts as read.
  const PackageFile* Find(const std::string& name);

  const ScenePackage package_;
  const std::string folder_;
  const FetchBlob fetch_;
  mutable std::mutex mutex_;
  ScenePackage read_;
};

// Fetches, parses and builds. An error, in words for the user, if a file cannot be had, the scene is bad, or
// its frame is not the one that was ordered. Takes from `cache` what was made of the same files for other
// scenes; it may be null.
Result<std::shared_ptr<const Scene>> LoadOrderedScene(const SceneOrder& order, const FetchBlob& fetch,
                                                      std::shared_ptr<SharedCache> cache = nullptr);

}  // namespace tessera
