// Scripts with which shells complete the commands and flags of `tessera`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "client/reference/reference.h"
#include "renderer/util/result.h"

namespace tessera {

// The script for one of the shells bash, zsh and fish. Bad input for others.
Result<std::string> CompletionScript(std::string_view shell, const std::vector<CommandReference>& commands);

}  // namespace tessera
