// Files and folders that only their user may read.
#pragma once

#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

// The bytes of a file with secrets. An error that says what to do if it belongs to another user or if others
// may read or change it.
Result<std::string> ReadPrivateFile(const std::string& path);

// Replaces `path` by a whole file with mode 0600 or not at all.
Result<void> WritePrivateFile(const std::string& path, std::string_view bytes);

// Creates the folder and those above it, as far as they are missing, the folder itself with mode 0700. An
// error if it is a link, belongs to another user or others may write to it.
Result<void> PreparePrivateFolder(const std::string& path);

}  // namespace tessera
