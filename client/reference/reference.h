// The command table as data: what help, completion scripts and manual pages are made of, so that they agree
// with what the command line accepts.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tessera {

// A command line that works as it is written, and what it does.
struct Example {
  std::string what;  // imperative: "Render at 256 samples per pixel"
  std::string line;  // "tessera render scene.pbrt --spp 256"
};

// A flag or an argument of a command.
struct FlagReference {
  std::vector<std::string> names;  // of a flag, with dashes, the short ones first; of an argument one without
  std::string type;                // of its word; empty: a switch, or an argument
  std::string help;
  bool is_required = false;

  // Whether its word, or the argument, names a file or a folder.
  bool TakesPath() const;
};

struct CommandReference {
  std::string name, summary;
  std::vector<FlagReference> flags, arguments;  // without those that help hides
  std::vector<Example> examples;
};

// What a subcommand accepts.
CommandReference ReferenceOf(const CLI::App& command, const std::vector<Example>& examples);

// The examples as the end of a help text.
std::string ExamplesText(const std::vector<Example>& examples);

}  // namespace tessera
