// How the files of a scene are called in its package, and how a picture says which package it shows. The client that
// packs, the worker that unpacks and everything that compares pictures must agree on both.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// The EXR attribute that holds the digest of the scene package's manifest, in hexadecimal.
constexpr const char* kSceneDigestAttribute = "tessera:scene";

// The path in a package (IsPackagePath) of a file that the scene calls `name`: the name itself where it is such a path.
// Absolute names, names with "." or ".." parts and strange characters are percent-encoded below "names/". Different
// names have different paths; nothing if the name is too long.
std::string PackagePath(std::string_view name);

}  // namespace tessera
