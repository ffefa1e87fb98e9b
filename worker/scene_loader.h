// From a scene order to a scene ready to render.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "proto/failure_cause.h"
#include "proto/scene_package.h"
#include "proto/terms.h"
#include "renderer/load/limited_load.h"
#include "renderer/scene/scene.h"
#include "renderer/util/result.h"

namespace tessera {

// Returns the bytes with the digest; an error if they cannot be fetched or are more than `size_max`. Called
// from any thread.
using FetchBlob = std::function<Result<std::string>(const Digest& digest, uint64_t size_max)>;

// The files of one scene in a package, under the names that the scene uses. Files that the manifest does not
// name do not exist, so a scene can read nothing else on this machine. Thread safe.
class PackageFileSource : public FileSource {
 public:
  // `folder` is the part of the package that holds the scene's files (PackageFolder).
  PackageFileSource(ScenePackage package, std::string folder, FetchBlob fetch,
                    std::shared_ptr<SharedCache> cache = nullptr)
      : FileSource(std::move(cache)),
        package_(std::move(package)),
        folder_(std::move(folder)),
        fetch_(std::move(fetch)) {}
  Result<std::string> Read(const std::string& name) override;
  // The package of the files read so far: the one that this scene alone would have.
  ScenePackage PackageRead() const;

 protected:
  std::optional<Digest> Identify(const std::string& name) override;

 private:
  // Null if there is no file of that name. Otherwise it counts as read.
  const PackageFile* Find(const std::string& name);

  const ScenePackage package_;
  const std::string folder_;
  const FetchBlob fetch_;
  mutable std::mutex mutex_;
  ScenePackage read_;
};

// Fetches, parses and builds. An error, for the user to read, if a file cannot be fetched, the scene is
// invalid or its frame is not the one that was ordered. Reuses what `cache`, which may be null, holds of the
// same files.
Result<std::shared_ptr<const Scene>> LoadOrderedScene(const SceneRequest& order, const FetchBlob& fetch,
                                                      std::shared_ptr<SharedCache> cache = nullptr);

// A scene that is ready to render, or why there is none.
struct LoadOutcome {
  std::shared_ptr<const Scene> scene;  // null: it could not be loaded
  std::string reason;                  // one line, for the user to read
  FailureCause cause = FailureCause::kScene;
};

// The same within limits. A limit that is exceeded and a file that could not be fetched are the worker's
// limits; a file that does not exist, or anything else that throws while the scene is loaded, is the scene's
// fault.
LoadOutcome LoadOrderedScene(const SceneRequest& order, const LoadLimits& limits, const FetchBlob& fetch,
                             std::shared_ptr<SharedCache> cache = nullptr);

}  // namespace tessera
