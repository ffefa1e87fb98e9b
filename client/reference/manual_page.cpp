#include "client/reference/manual_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "proto/terms.h"

namespace tessera {
namespace {

// Dashes are what is typed, and neither a backslash nor a dot at the start of a line is a request.
std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char each : text) {
    if (each == '\\') {
      escaped += "\\e";
    } else if (each == '-') {
      escaped += "\\-";
    } else if ((each == '.' || each == '\'') && (escaped.empty() || escaped.back() == '\n')) {
      escaped += std::string("\\&") + each;
    } else {
      escaped += each;
    }
  }
  return escaped;
}

std::string Heading(const std::string& name, const std::string& summary) {
  std::string title = name;
  std::ranges::transform(title, title.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return fmt::format(".TH \"{}\" 1 \"\" \"Tessera {}\" \"Tessera\"\n.SH NAME\n{} \\- {}\n", Escaped(title),
                     kSoftwareVersion, Escaped(name), Escaped(summary));
}

std::string Entry(const FlagReference& flag) {
  const std::string word = flag.type.empty() ? "" : " \\fI" + Escaped(flag.type) + "\\fR";
  std::vector<std::string> names;
  for (const std::string& each : flag.names) names.push_back("\\fB" + Escaped(each) + "\\fR" + word);
  return fmt::format(".TP\n{}\n{}\n", fmt::join(names, ", "), Escaped(flag.help));
}

constexpr const char* kCommonEnd = R"(.SH EXIT STATUS
.TP
\fB0\fR
Success.
.TP
\fB1\fR
The render or the farm failed.
.TP
\fB2\fR
The command line or the input is wrong.
.TP
\fB130\fR
Interrupted.
)";

}  // namespace

std::string ManualPage(const CommandReference& command) {
  const std::string name = "tessera-" + command.name;
  std::string page = Heading(name, command.summary);
  page += fmt::format(".SH SYNOPSIS\n\\fBtessera {}\\fR [\\fIOPTIONS\\fR]", Escaped(command.name));
  for (const FlagReference& each : command.arguments) {
    const std::string name_of_word = "\\fI" + Escaped(each.names.front()) + "\\fR";
    page += each.is_required ? " " + name_of_word : " [" + name_of_word + "]";
  }
  page += "\n";
  if (!command.arguments.empty()) page += ".SH ARGUMENTS\n";
  for (const FlagReference& each : command.arguments) page += Entry(each);
  page += ".SH OPTIONS\n";
  for (const FlagReference& each : command.flags) page += Entry(each);
  if (!command.examples.empty()) page += ".SH EXAMPLES\n";
  for (const Example& each : command.examples)
    page += fmt::format("{}:\n.PP\n.nf\n.RS\n{}\n.RE\n.fi\n.PP\n", Escaped(each.what), Escaped(each.line));
  return page + kCommonEnd + ".SH SEE ALSO\n\\fBtessera\\fR(1)\n";
}

std::string ManualPage(const std::vector<CommandReference>& commands) {
  std::string page = Heading("tessera", "render scenes on this machine or on a farm of machines");
  page += ".SH SYNOPSIS\n\\fBtessera\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH COMMANDS\n";
  for (const CommandReference& each : commands)
    page += fmt::format(".TP\n\\fB{}\\fR\n{}. See \\fBtessera\\-{}\\fR(1).\n", Escaped(each.name),
                        Escaped(each.summary), Escaped(each.name));
  return page + kCommonEnd;
}

}  // namespace tessera
