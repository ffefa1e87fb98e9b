#include "client/commands/commands.h"

namespace tessera {

std::vector<Command> AllCommands() {
  std::vector<Command> commands;
  for (const MakeCommandFunction make : kCommands) commands.push_back(make());
  return commands;
}

}  // namespace tessera
