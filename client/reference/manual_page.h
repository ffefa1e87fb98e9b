// Manual pages of `tessera`, in the language of man(7).
#pragma once

#include <string>
#include <vector>

#include "client/reference/reference.h"

namespace tessera {

// The page of one command, tessera-COMMAND(1).
std::string ManualPage(const CommandReference& command);
// The page tessera(1), which lists all commands.
std::string ManualPage(const std::vector<CommandReference>& commands);

}  // namespace tessera
