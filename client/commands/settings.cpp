#include "client/commands/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

#include "renderer/util/file.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr uint64_t kSettingsBytesMax = uint64_t{1} << 20;  // nobody writes more by hand

std::string Trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

// Of flags that exclude each other, such as two ways to name a farm, a later layer must not add one beside
// that of an earlier layer.
const std::set<std::string>* AlternativesOf(const std::string& flag) {
  static const std::set<std::string> kGroups[] = {{"coordinator", "farm"}, {"in-process", "workers"}};
  for (const std::set<std::string>& group : kGroups) {
    if (group.contains(flag)) return &group;
  }
  return nullptr;
}

const FlagReference* FindFlag(const CommandReference& command, const std::string& flag) {
  for (const FlagReference& each : command.flags) {
    if (std::ranges::find(each.names, "--" + flag) != each.names.end()) return &each;
  }
  return nullptr;
}

std::string LongName(const FlagReference& flag) {
  for (const std::string& name : flag.names) {
    if (name.starts_with("--")) return name.substr(2);
  }
  return {};
}

bool IsGiven(const std::vector<std::string>& arguments, const FlagReference& flag) {
  return std::ranges::any_of(arguments, [&](const std::string& word) {
    return std::ranges::any_of(flag.names, [&](const std::string& name) {
      const bool is_short = !name.starts_with("--");
      return word == name || word.starts_with(name + "=") || (is_short && word.starts_with(name));
    });
  });
}

// Collects what is added, each flag once: whoever comes first.
class Additions {
 public:
  Additions(const std::vector<std::string>& arguments, const CommandReference& command) : command_(command) {
    for (const FlagReference& each : command.flags) {
      if (IsGiven(arguments, each)) taken_.insert(LongName(each));
    }
    Close();
  }
  Result<void> Add(const std::string& name, const std::string& value, const std::string& where) {
    const FlagReference* const flag = FindFlag(command_, name);
    if (flag == nullptr || IsTaken(name)) return {};
    taken_in_layer_.insert(name);
    if (!flag->type.empty()) {
      words_.push_back(fmt::format("--{}={}", name, value));
    } else if (value == "true" || value == "1") {
      words_.push_back("--" + name);
    } else if (value != "false" && value != "0") {
      return BadInput(fmt::format("{}: {} = {}: expected true or false", where, name, value));
    }
    return {};
  }
  // Everything added from now on comes from a later layer.
  void Close() {
    taken_.merge(taken_in_layer_);
    taken_in_layer_.clear();
  }
  const std::vector<std::string>& words() const { return words_; }

 private:
  bool IsTaken(const std::string& name) const {
    if (taken_in_layer_.contains(name)) return true;
    const std::set<std::string>* const group = AlternativesOf(name);
    if (group == nullptr) return taken_.contains(name);
    return std::ranges::any_of(*group, [this](const std::string& each) { return taken_.contains(each); });
  }

  const CommandReference& command_;
  std::set<std::string> taken_, taken_in_layer_;
  std::vector<std::string> words_;
};

Error UnknownSetting(const Setting& setting, const std::vector<const CommandReference*>& commands) {
  std::set<std::string> known;
  for (const CommandReference* command : commands) {
    for (const FlagReference& each : command->flags) known.insert(LongName(each));
  }
  const std::vector<std::string_view> names(known.begin(), known.end());
  const std::string what =
      setting.command.empty() ? "no command has the flag" : setting.command + " has no flag";
  return BadInput(
      fmt::format("{}: {} --{}{}", setting.where, what, setting.flag, DidYouMean(setting.flag, names)));
}

// Every setting is checked, whichever command is run: a mistake shows the first time.
Result<void> CheckSettings(const std::vector<CommandReference>& commands,
                           const std::vector<Setting>& settings) {
  std::vector<std::string_view> names;
  names.reserve(commands.size());
  for (const CommandReference& each : commands) names.push_back(each.name);
  for (const Setting& setting : settings) {
    std::vector<const CommandReference*> meant;
    for (const CommandReference& each : commands) {
      if (setting.command.empty() || each.name == setting.command) meant.push_back(&each);
    }
    if (meant.empty()) {
      return BadInput(fmt::format("{}: there is no command \"{}\"{}", setting.where, setting.command,
                                  DidYouMean(setting.command, names)));
    }
    const bool is_known = std::ranges::any_of(
        meant, [&](const CommandReference* each) { return FindFlag(*each, setting.flag) != nullptr; });
    if (!is_known || setting.flag == "help") return UnknownSetting(setting, meant);
  }
  return {};
}

std::string VariableOf(const std::string& flag) {
  std::string name = "TESSERA_";
  for (const char each : flag)
    name += each == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(each)));
  return name;
}

}  // namespace

std::string SettingsPath(const ReadVariable& environment) {
  if (std::string path = environment("TESSERA_CONFIG"); !path.empty()) return path;
  if (const std::string folder = environment("XDG_CONFIG_HOME"); !folder.empty())
    return folder + "/tessera/config";
  const std::string home = environment("HOME");
  return home.empty() ? "" : home + "/.config/tessera/config";
}

Result<std::vector<Setting>> ReadSettings(const std::string& path) {
  std::error_code error;
  if (path.empty() || !std::filesystem::exists(path, error)) return std::vector<Setting>();
  const auto text = ReadFile(path, kSettingsBytesMax);
  if (!text) return text.error();
  std::vector<Setting> settings;
  std::istringstream lines(*text);
  std::string line, command;
  for (int number = 1; std::getline(lines, line); ++number) {
    line = Trimmed(line);
    if (line.empty() || line.front() == '#' || line.front() == ';') continue;
    const std::string where = fmt::format("{}:{}", path, number);
    if (line.front() == '[' && line.back() == ']') {
      command = Trimmed(line.substr(1, line.size() - 2));
      continue;
    }
    const size_t equals = line.find('=');
    std::string flag = Trimmed(line.substr(0, equals));
    if (equals == std::string::npos || flag.empty())
      return BadInput(fmt::format("{}: expected [COMMAND] or FLAG = VALUE", where));
    if (flag.starts_with("--")) flag.erase(0, 2);
    settings.push_back({command, flag, Trimmed(line.substr(equals + 1)), where});
  }
  return settings;
}

Result<std::vector<std::string>> WithSettings(std::vector<std::string> arguments,
                                              const std::vector<CommandReference>& commands,
                                              const std::vector<Setting>& settings,
                                              const ReadVariable& environment) {
  const auto asks_for_help = [](const std::string& word) { return word == "--help" || word == "-h"; };
  if (arguments.empty() || std::ranges::any_of(arguments, asks_for_help)) return arguments;
  const auto command = std::ranges::find(commands, arguments.front(), &CommandReference::name);
  if (command == commands.end()) return arguments;
  if (const auto known = CheckSettings(commands, settings); !known) return known.error();
  Additions additions(arguments, *command);
  for (const FlagReference& each : command->flags) {
    const std::string variable = VariableOf(LongName(each)), value = environment(variable.c_str());
    if (value.empty() || LongName(each) == "help") continue;
    if (const auto added = additions.Add(LongName(each), value, "$" + variable); !added) return added.error();
  }
  for (const bool is_general : {false, true}) {
    additions.Close();
    for (const Setting& each : settings) {
      if (each.command != (is_general ? "" : command->name)) continue;
      if (const auto added = additions.Add(each.flag, each.value, each.where); !added) return added.error();
    }
  }
  // Before the words of the user, of which the last may end the flags ("--").
  arguments.insert(arguments.begin() + 1, additions.words().begin(), additions.words().end());
  return arguments;
}

}  // namespace tessera
