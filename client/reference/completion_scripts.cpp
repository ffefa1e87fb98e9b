#include "client/reference/completion_scripts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace tessera {
namespace {

// Within single quotes of a shell: nothing but the quote itself means anything.
std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char each : text) quoted += each == '\'' ? std::string("'\\''") : std::string(1, each);
  return quoted + "'";
}

// The first sentence or clause: completion lists have little room.
std::string Brief(const std::string& help) {
  return help.substr(0, std::min(help.find(" [default:"), help.find_first_of(";:")));
}

std::vector<std::string> NamesOf(const std::vector<CommandReference>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CommandReference& each : commands) names.push_back(each.name);
  return names;
}

bool TakesPath(const CommandReference& command) {
  return std::ranges::any_of(command.arguments, &FlagReference::TakesPath);
}

bool IsChoice(std::string_view word) {
  return !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_' || c == '-';
  });
}

// The words that the help lists after a colon: "Structure: embree, bvh or list". Empty if it lists something
// else.
std::vector<std::string> ChoicesIn(const std::string& help) {
  size_t at = help.find(": ");
  if (at == std::string::npos) return {};
  std::string list = help.substr(0, std::min(help.find(" [default:"), help.find(';')));
  list = at < list.size() ? list.substr(at + 2) : "";
  const size_t remark = list.find(" (");
  if (remark != std::string::npos && list.ends_with(')')) list.resize(remark);
  std::vector<std::string> choices;
  for (at = 0; at < list.size();) {
    const size_t end = std::min({list.find(", ", at), list.find(" or ", at), list.size()});
    std::string word = list.substr(at, end - at);
    at = end + (list.compare(end, 2, ", ") == 0 ? 2 : 4);
    if (list.compare(std::min(at, list.size()), 3, "or ") == 0) at += 3;
    if (!IsChoice(word)) return {};
    choices.push_back(std::move(word));
  }
  return choices.size() > 1 ? choices : std::vector<std::string>();
}

bool TakesList(const FlagReference& flag) {
  return flag.type == "LIST";
}

// What the word of a flag, or an argument, may be; empty if that is not known.
std::string Choices(const FlagReference& flag, const std::vector<CommandReference>& commands) {
  const bool is_command = flag.type.empty() && flag.names.front() == "COMMAND";
  return fmt::to_string(fmt::join(is_command ? NamesOf(commands) : ChoicesIn(flag.help), " "));
}

// The names of those flags that are switches, take a path or take another word.
enum class Word { kNone, kPath, kOther };
std::vector<std::string> FlagsWith(const CommandReference& command, Word word) {
  std::vector<std::string> names;
  for (const FlagReference& each : command.flags) {
    const Word takes = each.type.empty() ? Word::kNone : each.TakesPath() ? Word::kPath : Word::kOther;
    if (takes == word) names.insert(names.end(), each.names.begin(), each.names.end());
  }
  return names;
}

// The choices of the flag before the word that is completed.
std::string BashChoices(const CommandReference& command, const std::vector<CommandReference>& commands) {
  std::string cases;
  for (const FlagReference& flag : command.flags) {
    const std::string choices = flag.type.empty() ? "" : Choices(flag, commands);
    if (choices.empty()) continue;
    cases += fmt::format("        {}) choices={} ;;\n", fmt::join(flag.names, "|"), Quoted(choices));
  }
  return cases.empty() ? cases : fmt::format("      case $prev in\n{}      esac\n", cases);
}

std::string BashScript(const std::vector<CommandReference>& commands) {
  std::string cases;
  for (const CommandReference& each : commands) {
    const std::vector<std::string> switches = FlagsWith(each, Word::kNone);
    const std::vector<std::string> paths = FlagsWith(each, Word::kPath);
    const std::vector<std::string> others = FlagsWith(each, Word::kOther);
    cases += fmt::format("    {}) switches={}; paths={}; words={}; takes_path={}; arguments={}\n", each.name,
                         Quoted(fmt::to_string(fmt::join(switches, " "))),
                         Quoted(fmt::to_string(fmt::join(paths, " "))),
                         Quoted(fmt::to_string(fmt::join(others, " "))), TakesPath(each) ? "yes" : "no",
                         Quoted(each.arguments.empty() ? "" : Choices(each.arguments.front(), commands)));
    cases += BashChoices(each, commands) + "      ;;\n";
  }
  return fmt::format(R"(# bash completion of tessera: source <(tessera completion bash)
_tessera() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command="" i
  local switches="" paths="" words="" takes_path=no arguments="" choices=""
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${{COMP_WORDS[i]}} == -* ]] || {{ command=${{COMP_WORDS[i]}}; break; }}
  done
  if [[ -z $command ]]; then
    mapfile -t COMPREPLY < <(compgen -W {0} -- "$cur")
    return
  fi
  case $command in
{1}    *) return ;;
  esac
  if [[ -n $choices ]]; then
    mapfile -t COMPREPLY < <(compgen -P "${{cur%"${{cur##*,}}"}}" -W "$choices" -- "${{cur##*,}}")
    return
  elif [[ " $paths " == *" $prev "* ]]; then
    takes_path=yes
  elif [[ " $words " == *" $prev "* ]]; then
    return
  elif [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$switches $paths $words" -- "$cur")
    return
  fi
  if [[ $takes_path == yes ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  else
    mapfile -t COMPREPLY < <(compgen -W "$arguments" -- "$cur")
  fi
}}
complete -F _tessera tessera
)",
                     Quoted(fmt::format("{} --help --version", fmt::join(NamesOf(commands), " "))), cases);
}

// Of _arguments: brackets and colons end a description there.
std::string ZshText(const std::string& help) {
  std::string text;
  for (const char each : Brief(help)) {
    if (each == '[' || each == ']' || each == ':' || each == '\\') text += '\\';
    text += each;
  }
  return text;
}

// How _arguments completes a word.
std::string ZshAction(const FlagReference& flag, const std::vector<CommandReference>& commands) {
  if (flag.TakesPath()) return "_files";
  const std::string choices = Choices(flag, commands);
  if (choices.empty()) return " ";
  return TakesList(flag) ? "_values -s , name " + choices : "(" + choices + ")";
}

std::string ZshFlag(const FlagReference& flag, const std::string& name,
                    const std::vector<CommandReference>& commands) {
  std::string spec = fmt::format("{}[{}]", name, ZshText(flag.help));
  if (!flag.type.empty()) spec += fmt::format(":{}:{}", ZshText(flag.type), ZshAction(flag, commands));
  return Quoted(spec);
}

std::string ZshScript(const std::vector<CommandReference>& commands) {
  std::string list, cases;
  for (const CommandReference& each : commands) {
    list += fmt::format("    {}\n", Quoted(each.name + ":" + ZshText(each.summary)));
    cases += fmt::format("    {})\n      _arguments", each.name);
    for (const FlagReference& flag : each.flags) {
      for (const std::string& name : flag.names) cases += " \\\n        " + ZshFlag(flag, name, commands);
    }
    for (const FlagReference& argument : each.arguments) {
      cases += " \\\n        " +
               Quoted(fmt::format(":{}:{}", ZshText(argument.names.front()), ZshAction(argument, commands)));
    }
    cases += " ;;\n";
  }
  return fmt::format(R"(#compdef tessera
# zsh completion of tessera: tessera completion zsh > ~/.zfunc/_tessera, with ~/.zfunc in $fpath
_tessera() {{
  local -a commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}  esac
}}
if [[ $funcstack[1] == _tessera ]]; then
  _tessera "$@"
else
  compdef _tessera tessera
fi
)",
                     list, cases);
}

std::string FishScript(const std::vector<CommandReference>& commands) {
  std::string script =
      "# fish completion of tessera: tessera completion fish > ~/.config/fish/completions/tessera.fish\n"
      "complete -c tessera -f\n";
  // In fish, a backslash means something within single quotes, too.
  const auto text = [](const std::string& help) {
    std::string escaped;
    for (const char each : Brief(help)) {
      if (each == '\'' || each == '\\') escaped += '\\';
      escaped += each;
    }
    return "'" + escaped + "'";
  };
  for (const CommandReference& each : commands) {
    script += fmt::format("complete -c tessera -n __fish_use_subcommand -a {} -d {}\n", each.name,
                          text(each.summary));
    const std::string condition = fmt::format("-n '__fish_seen_subcommand_from {}'", each.name);
    if (TakesPath(each)) script += fmt::format("complete -c tessera {} -F\n", condition);
    for (const FlagReference& argument : each.arguments) {
      const std::string choices = argument.TakesPath() ? "" : Choices(argument, commands);
      if (!choices.empty()) script += fmt::format("complete -c tessera {} -a '{}'\n", condition, choices);
    }
    for (const FlagReference& flag : each.flags) {
      script += fmt::format("complete -c tessera {}", condition);
      for (const std::string& name : flag.names)
        script += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      script += flag.type.empty() ? "" : flag.TakesPath() ? " -r -F" : " -x";
      const std::string choices = flag.type.empty() || flag.TakesPath() ? "" : Choices(flag, commands);
      if (!choices.empty())
        script += TakesList(flag) ? fmt::format(" -a '(__fish_append , {})'", choices)
                                  : fmt::format(" -a '{}'", choices);
      script += fmt::format(" -d {}\n", text(flag.help));
    }
  }
  return script;
}

}  // namespace

Result<std::string> CompletionScript(std::string_view shell, const std::vector<CommandReference>& commands) {
  if (shell == "bash") return BashScript(commands);
  if (shell == "zsh") return ZshScript(commands);
  if (shell == "fish") return FishScript(commands);
  return BadInput(
      fmt::format("there is no completion for the shell \"{}\"; there is for bash, zsh and fish", shell));
}

}  // namespace tessera
