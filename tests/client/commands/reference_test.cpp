// Help, completion and manual pages of the real commands, in the programs that read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "client/commands/command_line.h"
#include "client/commands/commands.h"
#include "client/reference/completion_scripts.h"
#include "client/reference/manual_page.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;

// What a shell command prints, with its errors.
std::string OutputOf(const std::string& command) {
  FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");
  std::string output;
  char buffer[4096];
  for (size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, got);
  ::pclose(pipe);
  return output;
}

bool IsInstalled(const std::string& program) {
  return !OutputOf("command -v " + program).empty();
}

// The words of an example that its own program gets: up to a pipe or a redirection.
std::vector<std::string> WordsOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word && word != "|" && word != ">" && word != ">>" && word != "&&";)
    words.push_back(word);
  return words;
}

TEST(Examples, EveryCommandHasSomeThatItsCommandLineAccepts) {
  for (const Command& command : AllCommands()) {
    EXPECT_FALSE(command.examples.empty()) << command.name;
    for (const Example& example : command.examples) {
      std::vector<std::string> words = WordsOf(example.line);
      ASSERT_GE(words.size(), 2u) << example.line;
      EXPECT_EQ(words[0], "tessera") << example.line;
      EXPECT_EQ(words[1], command.name) << example.line;
      words.erase(words.begin());
      const auto parsed = ParseCommandLine(AllCommands(), words);
      EXPECT_TRUE(parsed) << example.line << ": " << parsed.error().message;
    }
  }
}

TEST(Examples, AreInTheHelp) {
  const auto help = ParseCommandLine(AllCommands(), {"fetch", "--help"});
  ASSERT_TRUE(help);
  EXPECT_THAT(help->answer, HasSubstr("Examples:"));
  EXPECT_THAT(help->answer, HasSubstr("tessera fetch 12 -o picture.exr"));
}

class Shell : public testing::Test {
 protected:
  Shell() { std::ofstream(script_) << *CompletionScript("bash", ReferenceOf(AllCommands())); }
  // What bash offers for the last word.
  std::vector<std::string> Offered(const std::vector<std::string>& words) const {
    std::string list;
    for (const std::string& each : words) list += "'" + each + "' ";
    const std::string output =
        OutputOf("cd '" + folder_.path() + "' && bash -c 'source ./script; COMP_WORDS=(" + Escaped(list) +
                 "); COMP_CWORD=" + std::to_string(words.size() - 1) +
                 "; _tessera; printf \"%s\\n\" \"${COMPREPLY[@]}\"'");
    std::istringstream lines(output);
    std::vector<std::string> offered;
    for (std::string line; std::getline(lines, line);) offered.push_back(line);
    return offered;
  }

  const TemporaryDir folder_;
  const std::string script_ = folder_ / "script";

 private:
  // Within the single quotes of bash -c.
  static std::string Escaped(const std::string& text) {
    std::string escaped;
    for (const char each : text) escaped += each == '\'' ? std::string("'\\''") : std::string(1, each);
    return escaped;
  }
};

TEST_F(Shell, BashCompletesCommandsFlagsAndFiles) {
  if (!IsInstalled("bash")) GTEST_SKIP() << "bash is not installed";
  std::ofstream(folder_ / "scene one.pbrt") << "";
  EXPECT_THAT(Offered({"tessera", "ren"}), testing::ElementsAre("render"));
  for (const Command& each : AllCommands()) EXPECT_THAT(Offered({"tessera", ""}), Contains(each.name));
  EXPECT_THAT(Offered({"tessera", "render", "--noise"}), testing::ElementsAre("--noise-threshold"));
  EXPECT_THAT(Offered({"tessera", "render", "sc"}), Contains("scene one.pbrt"));
  EXPECT_THAT(Offered({"tessera", "render", "-o", "sc"}), Contains("scene one.pbrt"));
  EXPECT_THAT(Offered({"tessera", "render", "--spp", ""}), testing::ElementsAre(""));
  EXPECT_THAT(Offered({"tessera", "status", "sc"}), testing::ElementsAre("")) << "a job is no file";
  EXPECT_THAT(Offered({"tessera", "render", "--camera"}), testing::ElementsAre("")) << "hidden flags";
}

TEST_F(Shell, BashCompletesWordsThatAreKnown) {
  if (!IsInstalled("bash")) GTEST_SKIP() << "bash is not installed";
  EXPECT_THAT(Offered({"tessera", "completion", ""}), testing::ElementsAre("bash", "zsh", "fish"));
  EXPECT_THAT(Offered({"tessera", "man", "watc"}), testing::ElementsAre("watch"));
  EXPECT_THAT(Offered({"tessera", "render", "--exr-type", ""}), testing::ElementsAre("half", "float"));
  EXPECT_THAT(Offered({"tessera", "render", "--accelerator", "b"}), testing::ElementsAre("bvh"));
  EXPECT_THAT(Offered({"tessera", "render", "--aov", "albedo,dep"}), testing::ElementsAre("albedo,depth"));
  EXPECT_THAT(Offered({"tessera", "render", "--denoiser", ""}), testing::ElementsAre("regression", "oidn"));
  EXPECT_THAT(Offered({"tessera", "render", "--denoise", "--j"}), testing::ElementsAre("--json"));
}

TEST_F(Shell, TheOtherShellsAcceptTheirScripts) {
  for (const std::string shell : {"zsh", "fish"}) {
    if (!IsInstalled(shell)) continue;
    std::ofstream(folder_ / shell) << *CompletionScript(shell, ReferenceOf(AllCommands()));
    EXPECT_EQ(OutputOf(shell + " -n '" + (folder_ / shell) + "'"), "") << shell;
  }
}

TEST(ManualPages, AreReadByGroffWithoutWarnings) {
  if (!IsInstalled("groff")) GTEST_SKIP() << "groff is not installed";
  const TemporaryDir folder;
  const std::vector<CommandReference> commands = ReferenceOf(AllCommands());
  std::ofstream(folder / "page") << ManualPage(commands);
  EXPECT_EQ(OutputOf("groff -man -Tutf8 -ww -z '" + (folder / "page") + "'"), "");
  for (const CommandReference& each : commands) {
    std::ofstream(folder / "page") << ManualPage(each);
    EXPECT_EQ(OutputOf("groff -man -Tutf8 -ww -z '" + (folder / "page") + "'"), "") << each.name;
  }
  std::ofstream(folder / "page") << ManualPage(commands.front());
  EXPECT_THAT(OutputOf("groff -man -Tascii -P-cbou '" + (folder / "page") + "'"),
              HasSubstr("--noise-threshold E"));
}

}  // namespace
}  // namespace tessera
