// The folder of the cache: where it is, and that it belongs to this user alone.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "proto/blobs/blob_folder.h"
#include "renderer/util/result.h"

namespace tessera {

// The value of an environment variable; empty if it is not set.
using ReadEnvironment = std::function<std::string(const char* variable)>;

// $XDG_CACHE_HOME/tessera, $CACHE_DIRECTORY (set by systemd), ~/.cache/tessera, $STATE_DIRECTORY/cache
// (systemd) or, without any of them, a folder of this user in the temporary folder.
std::string DefaultCacheFolder(const ReadEnvironment& environment);

// Creates the folder if there is none, with mode 0700, and opens it. An error if it is a link or belongs to
// another user, who could put links and files into it, or if everybody could write to it before.
Result<std::shared_ptr<const BlobFolder>> OpenCacheFolder(const std::string& path);

}  // namespace tessera
