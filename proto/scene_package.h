// A scene package: the files of a scene by their paths. Its manifest is a blob, too, and the digest of the
// manifest names the package. Immutable values.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

constexpr int kFilesPerPackageMax = 100'000;
constexpr uint64_t kManifestBytesMax = uint64_t{64} << 20;

struct PackageFile {
  Digest digest;
  uint64_t size = 0;
  auto operator<=>(const PackageFile&) const = default;
};

struct ScenePackage {
  std::map<std::string, PackageFile> files;  // by path; see IsPackagePath
  bool operator==(const ScenePackage&) const = default;
};

// Whether a path stays inside a package: relative, '/' between non-empty parts none of which is "." or "..",
// no control characters or backslashes, within kPathBytesMax.
bool IsPackagePath(std::string_view path);

// Text: "tessera-package 1\n", then "DIGEST SIZE PATH\n" for each file in order of path. Equal packages
// give equal bytes, so comparing digests of manifests compares packages.
std::string EncodeScenePackage(const ScenePackage& package);
// Refuses any text that EncodeScenePackage would not have written; the message names the line.
Result<ScenePackage> DecodeScenePackage(std::string_view manifest);

}  // namespace tessera
