#include "proto/shell/flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "proto/shell/log.h"
#include "proto/terms.h"

namespace tessera {
namespace {

using testing::HasSubstr;

struct Values {
  int threads = 2;
  uint64_t size = uint64_t{20} << 30;
  std::string level = kLogLevelDefault;
  std::vector<std::string> tags;
  std::string name;
  bool quiet = false;
};

void AddAll(CLI::App& app, Values& values) {
  AddInteger(app, "--threads", "Threads", 1, 8, values.threads);
  AddSize(app, "--cache-size,--old-name", "Cache", 1024, values.size);
  AddRepeatedWord(app, "--tag", "TAG", "Tag", 2, [&values](const std::string& word) -> Result<void> {
    values.tags.push_back(word);
    return {};
  });
  AddText(app, "-o,--output", "FILE", "Name", values.name);
  AddSwitch(app, "--quiet", "Quiet", values.quiet);
  AddLogLevel(app, values.level);
}

Result<std::string> Parse(Values& values, std::vector<std::string> arguments) {
  CLI::App app("About.", "program");
  AddAll(app, values);
  return ParseArguments(app, std::move(arguments));
}

TEST(Flags, SetTheirTargets) {
  Values values;
  const auto parsed = Parse(values, {"--threads", "3", "--old-name=1M", "--tag", "a", "--tag", "b", "--quiet",
                                     "--log-level", "debug", "-o", "a.exr"});
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(*parsed, "");
  EXPECT_EQ(values.threads, 3);
  EXPECT_EQ(values.size, uint64_t{1} << 20);
  EXPECT_EQ(values.tags, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(values.name, "a.exr");
  EXPECT_TRUE(values.quiet);
  EXPECT_EQ(values.level, "debug");
}

TEST(Flags, BadUsageIsRefusedWithWhatWasExpected) {
  const std::pair<std::vector<std::string>, const char*> table[] = {
      {{"--thread", "3"}, "unknown flag \"--thread\" (did you mean \"--threads\"?)"},
      {{"--cachesize=3G"}, "unknown flag \"--cachesize\" (did you mean \"--cache-size\"?)"},
      {{"word"}, "unexpected word \"word\""},
      {{"--threads", "9"}, "--threads: \"9\" is not a whole number from 1 to 8"},
      {{"--cache-size", "1"}, "--cache-size: \"1\" is less than 1K"},
      {{"--tag", "a", "--tag", "b", "--tag", "c"}, "--tag: given more than 2 times"},
      {{"--log-level", "inof"},
       "--log-level: \"inof\" is not one of debug, info, warning, error (did you mean"},
      {{"--threads"}, "--threads"},
      {{"-o", ""}, "-o,--output: the value is empty"},
      {{"--output="}, "--output"},
  };
  for (const auto& [arguments, message] : table) {
    Values values;
    const auto parsed = Parse(values, arguments);
    ASSERT_FALSE(parsed) << message;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(parsed.error().message, HasSubstr(message));
  }
}

TEST(Flags, AnUnknownCommandOrFlagOfACommandIsRefusedWithASuggestion) {
  const auto parse = [](std::vector<std::string> arguments) {
    CLI::App app("About.", "program");
    Values values;
    AddAll(*app.add_subcommand("render", "Render."), values);
    return ParseArguments(app, std::move(arguments));
  };
  EXPECT_TRUE(parse({"render", "--threads", "2"}));
  EXPECT_EQ(parse({"rendr"}).error().message, "unknown command \"rendr\" (did you mean \"render\"?)");
  EXPECT_EQ(parse({"render", "--thread=2"}).error().message,
            "render: unknown flag \"--thread\" (did you mean \"--threads\"?)");
  EXPECT_EQ(parse({"--threads", "2", "render"}).error().message,
            "--threads: write this flag after the command: program COMMAND --threads ...");
  EXPECT_EQ(parse({"render", "scene"}).error().message, "render: unexpected word \"scene\"");
  EXPECT_THAT(*parse({"render", "--help"}), HasSubstr("--threads"));
}

TEST(Flags, HelpAndVersionAreAnswers) {
  Values values;
  EXPECT_THAT(*Parse(values, {"--help"}), HasSubstr("Cache [default: 20G]"));
  EXPECT_EQ(*Parse(values, {"--version"}), std::string("program ") + kSoftwareVersion + "\n");
}

TEST(Help, IsWrappedBelowItsColumnButForExamples) {
  const std::string flag = "  --flag N                    ";
  const std::string column(30, ' ');
  ASSERT_EQ(flag.size(), column.size());
  const std::string help = "A line about the program that is rather long\n" + flag +
                           "Words that do not fit into one line of this terminal at all\n" +
                           "Examples:\n  # A line that is as long as it is, to be copied into a shell\n";
  EXPECT_EQ(WrappedHelp(help, 200), help);
  EXPECT_EQ(WrappedHelp(help, 62), "A line about the program that is rather long\n" + flag +
                                       "Words that do not fit into one\n" + column +
                                       "line of this terminal at all\n" +
                                       "Examples:\n  # A line that is as long as it is, to be copied into a "
                                       "shell\n");
  EXPECT_EQ(WrappedHelp("averylongwordthatcannotbebroken", 10), "averylongwordthatcannotbebroken\n");
  EXPECT_EQ(WrappedHelp("one two three four", 9), "one two\nthree\nfour\n");
}

TEST(Flags, AMissingWordNamesTheHelp) {
  CLI::App app("About.", "program");
  std::string word;
  AddText(app, "WORD", "", "A word", word, Presence::kRequired);
  EXPECT_THAT(ParseArguments(app, {}).error().message, HasSubstr("; see: program --help"));
}

}  // namespace
}  // namespace tessera
