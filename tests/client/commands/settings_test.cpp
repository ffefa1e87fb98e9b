#include "client/commands/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "client/commands/command_line.h"
#include "client/commands/commands.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;
using Arguments = std::vector<std::string>;

class SettingsFile : public testing::Test {
 protected:
  Result<Arguments> With(const Arguments& arguments, const std::string& text = "") const {
    std::ofstream(path_) << text;
    const auto settings = ReadSettings(path_);
    if (!settings) return settings.error();
    return WithSettings(arguments, ReferenceOf(AllCommands()), *settings, [this](const char* variable) {
      const auto found = environment_.find(variable);
      return found == environment_.end() ? std::string() : found->second;
    });
  }
  std::string ErrorOf(const std::string& text) const {
    const auto words = With({"jobs"}, text);
    EXPECT_FALSE(words) << text;
    return words ? "" : words.error().message;
  }

  const TemporaryDir folder_;
  const std::string path_ = folder_ / "config";
  std::map<std::string, std::string> environment_;
};

TEST_F(SettingsFile, MayBeMissing) {
  EXPECT_TRUE(ReadSettings(folder_ / "none")->empty());
  EXPECT_TRUE(ReadSettings("")->empty());
}

TEST_F(SettingsFile, IsFoundInTheFolderOfSettings) {
  std::map<std::string, std::string> variables{{"HOME", "/home/ada"}};
  const auto read = [&](const char* name) { return variables[name]; };
  EXPECT_EQ(SettingsPath(read), "/home/ada/.config/tessera/config");
  variables["XDG_CONFIG_HOME"] = "/etc/ada";
  EXPECT_EQ(SettingsPath(read), "/etc/ada/tessera/config");
  variables["TESSERA_CONFIG"] = "/tmp/my";
  EXPECT_EQ(SettingsPath(read), "/tmp/my");
}

TEST_F(SettingsFile, SetsFlagsOfAllCommandsAndOfOne) {
  const std::string text =
      "# my farm\n coordinator = farm:7700\r\nspp=8\n\n[render]\nspp = 64\nin-process = true\njson = false\n";
  EXPECT_THAT(*With({"jobs", "--json"}, text), ElementsAre("jobs", "--coordinator=farm:7700", "--json"));
  EXPECT_THAT(*With({"render", "s.pbrt"}, text), ElementsAre("render", "--spp=64", "--in-process", "s.pbrt"));
  EXPECT_THAT(*With({"extend", "3"}, text),
              UnorderedElementsAre("extend", "--spp=8", "--coordinator=farm:7700", "3"));
  EXPECT_THAT(*With({"rendr"}, text), ElementsAre("rendr")) << "the parser explains it";
  EXPECT_THAT(*With({}, text), ElementsAre());
  EXPECT_TRUE(ParseCommandLine(AllCommands(), *With({"render", "s.pbrt"}, text)));
}

TEST_F(SettingsFile, GivesWayToTheEnvironmentAndBothToWhatIsGiven) {
  const std::string text = "spp = 8\noutput = file.exr\n";
  environment_["TESSERA_SPP"] = "16";
  EXPECT_THAT(*With({"render", "s"}, text), ElementsAre("render", "--spp=16", "--output=file.exr", "s"));
  EXPECT_THAT(*With({"render", "s", "--spp", "2", "-oa.exr"}, text),
              ElementsAre("render", "s", "--spp", "2", "-oa.exr"));
  EXPECT_THAT(*With({"render", "s", "--spp=2", "--output", "b.exr"}, text),
              ElementsAre("render", "s", "--spp=2", "--output", "b.exr"));
}

TEST_F(SettingsFile, NamesNoFarmBesideTheOneThatIsNamed) {
  EXPECT_THAT(*With({"jobs", "--coordinator", "other:1"}, "farm = studio\n"),
              ElementsAre("jobs", "--coordinator", "other:1"));
  environment_["TESSERA_COORDINATOR"] = "other:1";
  EXPECT_THAT(*With({"jobs"}, "farm = studio\n"), ElementsAre("jobs", "--coordinator=other:1"));
}

TEST_F(SettingsFile, RefusesMistakesWithTheirPlace) {
  EXPECT_THAT(ErrorOf("spp\n"), HasSubstr("config:1: expected [COMMAND] or FLAG = VALUE"));
  EXPECT_THAT(ErrorOf("\ncoordinatr = a:1\n"),
              HasSubstr("config:2: no command has the flag --coordinatr (did you mean \"coordinator\"?)"));
  EXPECT_THAT(ErrorOf("[rendr]\nspp = 1\n"),
              HasSubstr("there is no command \"rendr\" (did you mean \"render\"?)"));
  EXPECT_THAT(ErrorOf("[jobs]\nspp = 1\n"), HasSubstr("jobs has no flag --spp"));
  EXPECT_THAT(ErrorOf("[jobs]\njson = maybe\n"), HasSubstr("config:2: json = maybe: expected true or false"));
  EXPECT_TRUE(With({"jobs", "--help"}, "[rendr]\nspp = 1\n")) << "help is always there";
}

}  // namespace
}  // namespace tessera
