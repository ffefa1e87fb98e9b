// Flags of a command line, alike in all programs. The names of flags and the texts of their help are the
// callers'; CLI11 reads the words. Its headers are slow to compile and not needed by those who only add
// flags.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "renderer/util/result.h"

namespace CLI {
class App;
}

namespace tessera {

// A checked command line.
template <typename Options>
struct CommandLineOf {
  Options options;
  // Not empty: the answer to --help or --version, to be printed instead of running with the options.
  std::string answer;
};

enum class Presence { kOptional, kRequired };

// Checks one word and stores its value; the error says what was expected.
using WordSetter = std::function<Result<void>(const std::string& word)>;

// A flag ("--name", "-o,--output") or a positional argument ("SCENE") with one word. `type` names the word in
// help.
void AddWord(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
             WordSetter set, Presence presence = Presence::kOptional);
// A flag that may be given up to `count_max` times, with one word each.
void AddRepeatedWord(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
                     int count_max, WordSetter set, Presence presence = Presence::kOptional);
// A word that is taken as it is, but may not be empty.
void AddText(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
             std::string& target, Presence presence = Presence::kOptional);
// A whole number.
void AddInteger(CLI::App& app, const std::string& name, const std::string& help, int min, int max,
                int& target, Presence presence = Presence::kOptional);
// A number of bytes (ParseSize). The present value of `target` is shown as the default.
void AddSize(CLI::App& app, const std::string& name, const std::string& help, uint64_t min, uint64_t& target);
// A flag without a word.
void AddSwitch(CLI::App& app, const std::string& name, const std::string& help, bool& target);
// --log-level. The present value of `target` is shown as the default.
void AddLogLevel(CLI::App& app, std::string& target);

// `help` with its default appended, in the one form that all programs use: "... [default: 20G]".
std::string WithDefault(const std::string& help, const std::string& value);

// Breaks lines of help that have more than `columns` bytes between words, and indents what follows as
// descriptions are.
std::string WrappedHelp(const std::string& help, size_t columns);

// Parses the arguments (without the program's name) with the flags of `app` and its subcommands. Returns the
// text to print if help or the version was asked for, else an empty string. An unknown flag, command or word
// is bad input; the message suggests the nearest known one.
Result<std::string> ParseArguments(CLI::App& app, std::vector<std::string> arguments);

}  // namespace tessera
