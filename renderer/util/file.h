// Whole files in and out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// The bytes of a regular file; an error that names the path if it cannot be read or holds more than
// `size_max`.
Result<std::string> ReadFile(const std::string& path, uint64_t size_max);

// Whether these are the first bytes of a gzip file (RFC 1952).
inline bool IsGzip(std::string_view bytes) {
  return bytes.starts_with("\x1f\x8b");
}

// Bytes that a byte of gzip may unpack to, and bytes that any file may. Scenes and meshes reach some 20,
// deflate 1032.
constexpr uint64_t kGunzipRatioMax = 64;
constexpr uint64_t kGunzipFloor = uint64_t{16} << 20;

// The bytes that a gzip file, of one or more members, unpacks to; an error that names `path` if damaged,
// larger than `size_max` or larger than its own size allows.
Result<std::string> Gunzip(std::string_view compressed, const std::string& path, uint64_t size_max);

// Replaces `path` by a whole file or not at all: writes beside it, syncs, renames, syncs the folder. On
// failure the temporary file is removed and what was at `path` is untouched. The umask applies to `mode`.
Result<void> WriteFileAtomically(const std::string& path, std::string_view bytes, unsigned mode = 0644);

// "PATH: WHAT: " with the reason that errno holds, as in "/data/journal: cannot be written: No space left on
// device".
Error SystemError(const std::string& path, const char* what);

// The paths of the files and folders in a folder, in no particular order. None if there is no such folder.
Result<std::vector<std::string>> ListFolder(const std::string& folder);

// Syncs a folder, so that what was created, renamed or removed in it survives a crash.
Result<void> SyncFolder(const std::string& folder);

// Creates a folder and those above it, as far as they are missing, so that they survive a crash.
Result<void> CreateFolders(const std::string& folder);

}  // namespace tessera
