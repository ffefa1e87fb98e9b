#include "proto/shell/flags.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>

#include "proto/shell/log.h"
#include "proto/shell/values.h"
#include "proto/terms.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

// Errors leave CLI11's callbacks as its exceptions.
void Apply(const WordSetter& set, const std::string& word) {
  if (const auto done = set(word); !done) throw CLI::ValidationError(done.error().message);
}

std::vector<std::string> FlagsOf(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
  }
  return flags;
}

std::vector<std::string> CommandsOf(const CLI::App& app) {
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands(nullptr)) commands.push_back(command->get_name());
  return commands;
}

std::string Complaint(const std::string& what, const std::string& word,
                      const std::vector<std::string>& known) {
  const std::string stem = word.substr(0, word.find('='));
  const std::vector<std::string_view> candidates(known.begin(), known.end());
  return fmt::format("{} \"{}\"{}", what, stem, DidYouMean(stem, candidates));
}

// Whether a command has the flag that this word gives.
bool IsFlagOfACommand(const CLI::App& app, const std::string& word) {
  const std::string stem = word.substr(0, word.find('='));
  return std::ranges::any_of(app.get_subcommands(nullptr), [&](const CLI::App* command) {
    return std::ranges::count(FlagsOf(*command), stem) > 0;
  });
}

// Describes the first word that neither the program nor its command knows; empty if there is none.
std::string UnknownWord(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    if (command->remaining().empty()) continue;
    const std::string word = command->remaining().front();
    const bool is_flag = word.starts_with("-");
    return Complaint(command->get_name() + (is_flag ? ": unknown flag" : ": unexpected word"), word,
                     FlagsOf(*command));
  }
  if (app.remaining().empty()) return {};
  const std::string word = app.remaining().front();
  if (word.starts_with("-") && IsFlagOfACommand(app, word))
    return fmt::format("{}: write this flag after the command: {} COMMAND {} ...", word, app.get_name(),
                       word);
  if (word.starts_with("-")) return Complaint("unknown flag", word, FlagsOf(app));
  const std::vector<std::string> commands = CommandsOf(app);
  return Complaint(commands.empty() ? "unexpected word" : "unknown command", word, commands);
}

// The command that was given, or the program.
const CLI::App& ChosenOf(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : *chosen.front();
}

// Texts that do not fit a terminal continue below their column. Examples, which are copied, and what is not
// printed on a terminal stay as they are.
std::string HelpOf(const CLI::App& app) {
  winsize window{};
  const bool is_terminal = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0;
  return is_terminal ? WrappedHelp(app.help(), window.ws_col) : app.help();
}

}  // namespace

std::string WrappedHelp(const std::string& help, size_t columns) {
  constexpr size_t kIndent = 30;  // where CLI11 starts descriptions
  std::string wrapped;
  bool is_example = false;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    is_example = is_example || line == "Examples:";
    const size_t indent = line.starts_with("  ") && columns > 2 * kIndent ? kIndent : 0;
    while (!is_example && line.size() > columns) {
      const size_t end = line.rfind(' ', columns);
      if (end == std::string::npos || end <= indent || line.find_first_not_of(' ') > end) break;
      wrapped += line.substr(0, end) + "\n";
      line = std::string(indent, ' ') + line.substr(end + 1);
    }
    wrapped += line + "\n";
  }
  return wrapped;
}

void AddWord(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
             WordSetter set, Presence presence) {
  app.add_option_function<std::string>(
         name, [set = std::move(set)](const std::string& word) { Apply(set, word); }, help)
      ->type_name(type)
      ->required(presence == Presence::kRequired);
}

void AddRepeatedWord(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
                     int count_max, WordSetter set, Presence presence) {
  const auto set_all = [name, count_max, set = std::move(set)](const std::vector<std::string>& words) {
    if (words.size() > static_cast<size_t>(count_max)) {
      throw CLI::ValidationError(fmt::format("{}: given more than {} times", name, count_max));
    }
    for (const std::string& word : words) Apply(set, word);
  };
  app.add_option_function<std::vector<std::string>>(name, set_all, help)
      ->type_name(type)
      ->allow_extra_args(false)
      ->required(presence == Presence::kRequired);
}

void AddText(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
             std::string& target, Presence presence) {
  const auto set = [name, &target](const std::string& word) -> Result<void> {
    // Most often a variable of the shell that is not set.
    if (word.empty()) return BadInput(fmt::format("{}: the value is empty", name));
    target = word;
    return {};
  };
  AddWord(app, name, type, help, set, presence);
}

void AddInteger(CLI::App& app, const std::string& name, const std::string& help, int min, int max,
                int& target, Presence presence) {
  const auto set = [name, min, max, &target](const std::string& word) -> Result<void> {
    const auto number = ParseInteger(name, word, min, max);
    if (!number) return number.error();
    target = static_cast<int>(*number);
    return {};
  };
  AddWord(app, name, "N", help, set, presence);
}

void AddSize(CLI::App& app, const std::string& name, const std::string& help, uint64_t min,
             uint64_t& target) {
  // A flag with several names, "--new,--old", is reported by its first.
  const auto set = [flag = name.substr(0, name.find(',')), min,
                    &target](const std::string& word) -> Result<void> {
    const auto size = ParseSize(flag, word, min);
    if (!size) return size.error();
    target = *size;
    return {};
  };
  AddWord(app, name, "SIZE", WithDefault(help, SizeText(target)), set);
}

void AddSwitch(CLI::App& app, const std::string& name, const std::string& help, bool& target) {
  app.add_flag(name, target, help);
}

void AddLogLevel(CLI::App& app, std::string& target) {
  const auto set = [&target](const std::string& word) -> Result<void> {
    auto level = ParseChoice("--log-level", word, LogLevels());
    if (!level) return level.error();
    target = std::move(*level);
    return {};
  };
  AddWord(app, "--log-level", "LEVEL",
          WithDefault("Least severe log lines to print: debug, info, warning or error", target), set);
}

std::string WithDefault(const std::string& help, const std::string& value) {
  return fmt::format("{} [default: {}]", help, value);
}

Result<std::string> ParseArguments(CLI::App& app, std::vector<std::string> arguments) {
  // Extras are allowed so that UnknownWord can report them with a suggestion.
  app.allow_extras();
  app.set_version_flag("--version", std::string(kSoftwareVersion), "Print the version and exit");
  for (CLI::App* command : app.get_subcommands(nullptr)) command->allow_extras();
  std::ranges::reverse(arguments);  // CLI11 takes them from the back
  std::string problem;
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    return HelpOf(app);  // of the command, if one was given
  } catch (const CLI::CallForVersion&) {
    return fmt::format("{} {}\n", app.get_name(), kSoftwareVersion);
  } catch (const CLI::RequiredError& e) {
    const CLI::App& chosen = ChosenOf(app);
    problem = fmt::format("{}; see: {}{} --help", e.what(), &chosen == &app ? "" : app.get_name() + " ",
                          chosen.get_name());
  } catch (const CLI::ParseError& e) {
    problem = e.what();
  }
  if (const std::string unknown = UnknownWord(app); !unknown.empty()) problem = unknown;
  if (!problem.empty()) return BadInput(problem);
  return std::string();
}

}  // namespace tessera
