#include "client/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace tessera {
namespace {

using testing::HasSubstr;

Result<CommandLine> Parse(const std::string& words) {
  std::istringstream stream(words);
  std::vector<std::string> arguments;
  for (std::string word; stream >> word;) arguments.push_back(word);
  return ParseCommandLine(arguments);
}

TEST(CommandLine, ReadsEveryRenderOption) {
  const auto parsed = Parse(
      "render s.pbrt -o o.exr --png o.png --workers 3 --threads 2 --in-process --spp 64 --resolution 640x480 "
      "--crop 0,0.5,0.25,1 --seed 18446744073709551615 --integrator volpath --accelerator bvh --max-depth 9 "
      "--tile-size 64 --exr-type float --noise-threshold 0.05 --aov samples --json");
  ASSERT_TRUE(parsed) << parsed.error().message;
  const Options& options = parsed->options;
  EXPECT_EQ(options.command, "render");
  EXPECT_EQ(options.scene, "s.pbrt");
  EXPECT_EQ(options.output, "o.exr");
  EXPECT_EQ(options.png, "o.png");
  EXPECT_EQ(options.workers, 3);
  EXPECT_EQ(options.threads, 2);
  EXPECT_TRUE(options.in_process);
  EXPECT_TRUE(options.json);
  const RenderOptions& render = options.render;
  EXPECT_EQ(render.samples_per_pixel, 64u);
  EXPECT_EQ(render.width, 640);
  EXPECT_EQ(render.height, 480);
  EXPECT_EQ(render.crop, (std::array<float, 4>{0, 0.5f, 0.25f, 1}));
  EXPECT_EQ(render.seed, 18446744073709551615u);
  EXPECT_EQ(render.integrator, "volpath");
  EXPECT_EQ(render.accelerator, "bvh");
  EXPECT_EQ(render.max_depth, 9);
  EXPECT_EQ(render.tile_size, 64);
  EXPECT_EQ(render.exr_type, ExrType::kFloat);
  EXPECT_EQ(render.noise_threshold, 0.05);
  EXPECT_EQ(render.aovs, std::set<std::string>{"samples"});
}

TEST(CommandLine, LeavesAloneWhatIsNotSaid) {
  const auto parsed = Parse("render s.pbrt");
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->options.render, RenderOptions());
}

TEST(CommandLine, ReadsTheCommandsOfAFarm) {
  const auto submit = Parse("submit s.pbrt --coordinator farm:99 --name film --priority -4 --watch --spp 8");
  ASSERT_TRUE(submit) << submit.error().message;
  EXPECT_EQ(submit->options.coordinator, "farm:99");
  EXPECT_EQ(submit->options.name, "film");
  EXPECT_EQ(submit->options.priority, -4);
  EXPECT_TRUE(submit->options.watch);
  const auto wishes = Parse("submit s.pbrt --require gpu --require linux-6 --verify 2.5%");
  ASSERT_TRUE(wishes) << wishes.error().message;
  EXPECT_EQ(wishes->options.required_tags, (std::set<std::string>{"gpu", "linux-6"}));
  EXPECT_DOUBLE_EQ(wishes->options.verify_share, 0.025);
  EXPECT_DOUBLE_EQ(Parse("render s.pbrt --verify 100")->options.verify_share, 1);
  EXPECT_EQ(Parse("drain blade-7")->options.worker, "blade-7");
  EXPECT_EQ(Parse("release blade-7")->options.worker, "blade-7");
  const auto fetch = Parse("fetch 12 --preview -o a.exr");
  ASSERT_TRUE(fetch) << fetch.error().message;
  EXPECT_EQ(fetch->options.job, 12u);
  EXPECT_TRUE(fetch->options.preview);
  EXPECT_FALSE(fetch->options.coordinator.empty());
  const auto priority = Parse("priority 12 -4");
  ASSERT_TRUE(priority) << priority.error().message;
  EXPECT_EQ(priority->options.job, 12u);
  EXPECT_EQ(priority->options.priority, -4);
  for (const char* words : {"status 1", "watch 1", "cancel 1", "pause 1", "resume 1", "jobs", "workers"})
    EXPECT_TRUE(Parse(words)) << words;
}

TEST(CommandLine, BadWordsAreNamedWithWhatWasExpected) {
  const struct {
    const char* words;
    const char* message;
  } cases[] = {
      {"", "no command"},
      {"rendr s.pbrt", "unknown command \"rendr\" (did you mean \"render\"?)"},
      {"render", "SCENE is required"},
      {"render s.pbrt --sp 3", "render: unknown flag \"--sp\" (did you mean \"--spp\"?)"},
      {"render s.pbrt --tilesize=3", "unknown flag \"--tilesize\" (did you mean \"--tile-size\"?)"},
      {"render s.pbrt other.pbrt", "render: unexpected word \"other.pbrt\""},
      {"render s.pbrt --spp 0", "--spp: \"0\" is not a whole number from 1 to 1048576"},
      {"render s.pbrt --spp 3.5", "--spp: \"3.5\""},
      {"render s.pbrt --spp", "--spp"},
      {"render s.pbrt --resolution 640", "--resolution: \"640\" is not WxH"},
      {"render s.pbrt --resolution -5x10", "--resolution: \"-5x10\""},
      {"render s.pbrt --resolution 640x480x3", "--resolution"},
      {"render s.pbrt --resolution 999999x2", "--resolution"},
      {"render s.pbrt --crop 0,1,0", "--crop: \"0,1,0\""},
      {"render s.pbrt --crop 0.5,0.5,0,1", "--crop"},
      {"render s.pbrt --crop 0,1.1,0,1", "--crop"},
      {"render s.pbrt --crop nan,1,0,1", "--crop"},
      {"render s.pbrt --seed -1", "--seed: \"-1\""},
      {"render s.pbrt --seed 18446744073709551616", "--seed"},
      {"render s.pbrt --accelerator embre", "(did you mean \"embree\"?)"},
      {"render s.pbrt --exr-type double", "--exr-type: \"double\" is neither half nor float"},
      {"render s.pbrt --tile-size 257", "--tile-size: \"257\""},
      {"render s.pbrt --workers 0", "--workers: \"0\""},
      {"render s.pbrt --frames 3-1", "--frames 3-1: the last frame comes before the first"},
      {"render s.pbrt --camera main", "--camera is not supported yet"},
      {"render s.pbrt --aov N", "--aov: \"N\" is not one of samples"},
      {"render s.pbrt --aov sample", "(did you mean \"samples\"?)"},
      {"render s.pbrt --aov samples,", "--aov: \"\" is not one of samples"},
      {"render s.pbrt --noise-threshold -0.1", "--noise-threshold: \"-0.1\" is not a number from 0 to 1"},
      {"render s.pbrt --noise-threshold 2", "--noise-threshold: \"2\""},
      {"render s.pbrt --noise-threshold nan", "--noise-threshold: \"nan\""},
      {"status", "JOB is required"},
      {"status soon", "JOB: \"soon\""},
      {"status 0", "JOB: \"0\""},
      {"compare a.exr", "B is required"},
      {"compare a.exr b.exr --tolerance -1", "--tolerance: \"-1\""},
      {"submit s.pbrt --priority 1000001", "--priority"},
      {"extend 3", "--spp is required"},
      {"extend 3 --spp 0", "--spp: \"0\""},
      {"priority 3", "N is required"},
      {"priority 3 high", "N: \"high\" is not a whole number from -1000000 to 1000000"},
      {"submit s.pbrt --require two,words", "--require: \"two,words\" is not a word"},
      {"submit s.pbrt --verify 101%", "--verify: \"101%\" is not a share from 0% to 100%"},
      {"submit s.pbrt --verify some", "--verify: \"some\""},
      {"submit s.pbrt --verify nan", "--verify: \"nan\""},
      {"drain", "WORKER is required"},
  };
  for (const auto& bad : cases) {
    const auto parsed = Parse(bad.words);
    ASSERT_FALSE(parsed) << bad.words;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kBadInput) << bad.words;
    EXPECT_THAT(parsed.error().message, HasSubstr(bad.message)) << bad.words;
  }
}

TEST(CommandLine, HelpAndVersionAreAnswers) {
  EXPECT_THAT(Parse("--help")->answer, HasSubstr("render"));
  EXPECT_THAT(Parse("render --help")->answer, HasSubstr("--spp"));
  EXPECT_THAT(Parse("--version")->answer, HasSubstr("tessera "));
}

}  // namespace
}  // namespace tessera
