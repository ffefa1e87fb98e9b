// Completion scripts and manual pages of a small command table. Those of the real one are tested with the
// commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/reference/completion_scripts.h"
#include "client/reference/manual_page.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<CommandReference> Table() {
  CommandReference render{"render",
                          "Render a scene",
                          {{{"-o", "--output"}, "FILE", "Picture file: [.exr], or 'png'"},
                           {{"--spp"}, "N", "Samples per pixel", false},
                           {{"--json"}, "", "Print JSON"},
                           {{"--type"}, "TYPE", "Type: half, or full (slow) [default: half]"},
                           {{"--aov"}, "LIST", "Layers, separated by commas: albedo, depth"}},
                          {{{"SCENE"}, "", "Scene file", true}},
                          {{"Render it", "tessera render .hidden.pbrt -o a\\b.exr"}}};
  return {render, {"jobs", "List the jobs", {}, {}, {}}};
}

TEST(FlagReference, KnowsWhichWordsArePaths) {
  const CommandReference render = Table().front();
  EXPECT_TRUE(render.flags[0].TakesPath());
  EXPECT_FALSE(render.flags[1].TakesPath());
  EXPECT_FALSE(render.flags[2].TakesPath());
  EXPECT_TRUE(render.arguments[0].TakesPath());
}

TEST(ExamplesText, IsEmptyWithoutExamples) {
  EXPECT_EQ(ExamplesText({}), "");
  EXPECT_EQ(ExamplesText({{"Do it", "tessera it"}}), "Examples:\n  # Do it\n  tessera it\n");
}

TEST(CompletionScript, KnowsThreeShells) {
  EXPECT_FALSE(CompletionScript("tcsh", Table()));
  EXPECT_THAT(*CompletionScript("bash", Table()), HasSubstr("complete -F _tessera tessera"));
  const std::string zsh = *CompletionScript("zsh", Table());
  EXPECT_THAT(zsh, HasSubstr("'--output[Picture file]:FILE:_files'"));
  EXPECT_THAT(zsh, HasSubstr("'--spp[Samples per pixel]:N: '"));
  const std::string fish = *CompletionScript("fish", Table());
  EXPECT_THAT(fish, HasSubstr("-s o -l output -r -F"));
  EXPECT_THAT(fish, HasSubstr("-l spp -x -d 'Samples per pixel'"));
}

TEST(CompletionScript, OffersTheWordsThatTheHelpLists) {
  EXPECT_THAT(*CompletionScript("bash", Table()), HasSubstr("--type) choices='half full' ;;"));
  const std::string zsh = *CompletionScript("zsh", Table());
  EXPECT_THAT(zsh, HasSubstr("'--type[Type]:TYPE:(half full)'"));
  EXPECT_THAT(zsh, HasSubstr("LIST:_values -s , name albedo depth'"));
  const std::string fish = *CompletionScript("fish", Table());
  EXPECT_THAT(fish, HasSubstr("-l type -x -a 'half full' -d"));
  EXPECT_THAT(fish, HasSubstr("-l aov -x -a '(__fish_append , albedo depth)' -d"));
}

TEST(ManualPage, EscapesWhatMeansSomethingToGroff) {
  const std::string page = ManualPage(Table().front());
  EXPECT_THAT(page, HasSubstr(".SH NAME\ntessera\\-render \\- Render a scene\n"));
  EXPECT_THAT(page, HasSubstr("tessera render .hidden.pbrt \\-o a\\eb.exr"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-output\\fR \\fIFILE\\fR"));
  EXPECT_THAT(ManualPage(Table()), HasSubstr("\\fBjobs\\fR\nList the jobs."));
}

TEST(ManualPage, LeavesOutHeadingsWithoutContents) {
  EXPECT_THAT(ManualPage(Table().back()), Not(HasSubstr(".SH EXAMPLES")));
  EXPECT_THAT(ManualPage(Table().back()), Not(HasSubstr(".SH ARGUMENTS")));
}

}  // namespace
}  // namespace tessera
