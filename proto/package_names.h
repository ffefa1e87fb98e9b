// The names of a scene's files in its package, and the attribute that tells which package a picture shows.
// The client that packs, the worker that unpacks and everything that compares pictures must agree on both.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// The EXR attribute that holds the digest of the scene package's manifest, in hexadecimal.
constexpr const char* kSceneDigestAttribute = "tessera:scene";

// The path in a package (IsPackagePath) of a file that the scene refers to by `name`: the name itself if it
// is such a path. Absolute names, names with "." or ".." parts, unusual characters or bytes that are not
// UTF-8 are percent-encoded below "names/". Different names have different paths. Empty if the name is too
// long.
std::string PackagePath(std::string_view name);

// The inverse of PackagePath. A path that no name has is returned unchanged.
std::string NameOfPackagePath(std::string_view path);

// The folder of a package (empty, or with a final '/') that holds the files of the scene in `scene_file`,
// which is folder + PackagePath(name without '/'). Frames of a sequence whose files are in folders of their
// own have one folder each, as the same name may mean different files.
std::string PackageFolder(std::string_view scene_file);

}  // namespace tessera
