#include "client/reference/reference.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <string_view>

namespace tessera {

bool FlagReference::TakesPath() const {
  constexpr std::string_view kPaths[] = {"FILE", "DIR", "SCENE", "A", "B", "PICTURE"};
  return std::ranges::find(kPaths, type.empty() ? std::string_view(names.front()) : std::string_view(type)) !=
         std::end(kPaths);
}

CommandReference ReferenceOf(const CLI::App& command, const std::vector<Example>& examples) {
  CommandReference reference{command.get_name(), command.get_description(), {}, {}, examples};
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    FlagReference flag;
    for (const std::string& name : option->get_snames()) flag.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flag.names.push_back("--" + name);
    flag.help = option->get_description();
    flag.is_required = option->get_required();
    const bool is_argument = flag.names.empty();
    if (is_argument) flag.names.push_back(option->get_name(true));
    if (!is_argument && option->get_items_expected_max() > 0) flag.type = option->get_type_name();
    (is_argument ? reference.arguments : reference.flags).push_back(std::move(flag));
  }
  return reference;
}

std::string ExamplesText(const std::vector<Example>& examples) {
  std::string text;
  for (const Example& each : examples) text += "\n  # " + each.what + "\n  " + each.line + "\n";
  return text.empty() ? text : "Examples:" + text;
}

}  // namespace tessera
