// Values of flags that a user sets once: in the environment and in a file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/reference/reference.h"
#include "renderer/util/result.h"

namespace tessera {

// One line of the file.
struct Setting {
  std::string command;  // that it is for; empty: for all that have the flag
  std::string flag;     // without dashes
  std::string value;
  std::string where;  // "FILE:LINE"
};

using ReadVariable = std::function<std::string(const char* variable)>;

// $TESSERA_CONFIG, or tessera/config in $XDG_CONFIG_HOME or ~/.config. Empty if there is no home.
std::string SettingsPath(const ReadVariable& environment);

// Reads lines of "flag = value" below headings of "[command]"; those above the first heading are for all
// commands. Lines that start with # or ; are comments. A file that does not exist has no settings.
Result<std::vector<Setting>> ReadSettings(const std::string& path);

// The arguments with a flag for each setting that they do not give themselves. What was given goes before the
// environment ($TESSERA_SPP for --spp), which goes before the section of the command, which goes before what
// is for all. A setting that no command knows is bad input.
Result<std::vector<std::string>> WithSettings(std::vector<std::string> arguments,
                                              const std::vector<CommandReference>& commands,
                                              const std::vector<Setting>& settings,
                                              const ReadVariable& environment);

}  // namespace tessera
