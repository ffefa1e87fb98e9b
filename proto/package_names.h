// How the files of a scene are called in its package, and how a picture says which package it shows. The
// client that packs, the worker that unpacks and everything that compares pictures must agree on both.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// The EXR attribute that holds the digest of the scene package's manifest, in hexadecimal.
constexpr const char* kSceneDigestAttribute = "tessera:scene";

// The path in a package (IsPackagePath) of a file that the scene calls `name`: the name itself where it is
// such a path. Absolute names, names with "." or ".." parts and strange characters are percent-encoded below
// "names/". Different names have different paths; nothing if the name is too long.
std::string PackagePath(std::string_view name);

// The name whose PackagePath `path` is; a path that is none's is its own.
std::string NameOfPackagePath(std::string_view path);

// The folder of a package, with its '/' and perhaps empty, that holds the files of the scene whose file is
// `scene_file`: that is folder + PackagePath(name without '/'). Frames of a sequence whose files lie in
// folders of their own have one each, as the same name may mean another file in each.
std::string PackageFolder(std::string_view scene_file);

}  // namespace tessera
