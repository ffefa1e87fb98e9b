#include "client/commands/command_line.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::vector<std::string> Words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

// Parses a command line of the program.
Result<CommandLine> Parse(const std::string& words) {
  std::vector<Command> commands;
  for (const MakeCommandFunction make : kCommands) commands.push_back(make());
  return ParseCommandLine(commands, Words(words));
}

// The options that `words` give a command with these flags.
template <typename Options>
Options Parsed(void (*add_flags)(CLI::App&, Options&), std::vector<std::string> words) {
  Options parsed;
  const Command command = MakeCommand<Options>({
      .name = "test",
      .summary = "",
      .add_flags = add_flags,
      .run = [&parsed](const Options& options, Cancellation&) -> Result<int> {
        parsed = options;
        return 0;
      },
  });
  words.insert(words.begin(), "test");
  const auto line = ParseCommandLine({command}, words);
  EXPECT_TRUE(line) << line.error().message;
  if (!line) return parsed;
  Cancellation cancellation;
  EXPECT_TRUE(line->run(cancellation));
  return parsed;
}

template <typename Options>
Options Parsed(void (*add_flags)(CLI::App&, Options&), const char* words) {
  return Parsed(add_flags, Words(words));
}

TEST(SceneFlags, ReadEveryOption) {
  const SceneOptions options = Parsed(
      AddSceneFlags,
      "s.pbrt --frames 3-9x2 --fps 30 --spp 64 --resolution 640x480 --crop 0,0.5,0.25,1 "
      "--seed 18446744073709551615 --integrator volpath --accelerator bvh --max-depth 9 --tile-size 64 "
      "--exr-type float --noise-threshold 0.05 --aov samples --pixelbounds 1,20,3,40 --quick --denoise "
      "--denoiser oidn --cryptomatte-levels 6 --disable-image-textures --disable-pixel-jitter "
      "--disable-wavelength-jitter "
      "--disable-texture-filtering --force-diffuse "
      "--displacement-edge-scale 0.5");
  EXPECT_EQ(options.path, "s.pbrt");
  EXPECT_EQ(options.frames, (FrameRange{3, 9, 2}));
  EXPECT_EQ(options.fps, 30);
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
  EXPECT_EQ(render.pixel_bounds, (std::array<int, 4>{1, 20, 3, 40}));
  EXPECT_TRUE(render.quick);
  EXPECT_TRUE(render.denoise);
  EXPECT_EQ(render.denoiser, Denoiser::kOidn);
  EXPECT_EQ(render.cryptomatte_levels, 6u);
  EXPECT_TRUE(render.disable_pixel_jitter);
  EXPECT_TRUE(render.disable_wavelength_jitter);
  EXPECT_TRUE(render.disable_texture_filtering);
  EXPECT_TRUE(render.disable_image_textures);
  EXPECT_TRUE(render.force_diffuse);
  EXPECT_EQ(render.displacement_edge_scale, 0.5f);
}

TEST(SceneFlags, LeaveTheDefaultsOfWhatIsNotGiven) {
  const SceneOptions options = Parsed(AddSceneFlags, "s.pbrt");
  EXPECT_EQ(options.render, RenderOptions());
  EXPECT_FALSE(options.frames);
  EXPECT_EQ(options.fps, kFramesPerSecondDefault);
}

TEST(ConnectionFlags, ComeFromTheEnvironmentUnlessTheyAreGiven) {
  ::unsetenv("TESSERA_COORDINATOR");
  EXPECT_EQ(Parsed(AddConnectionFlags, "").farm.coordinator, "");
  EXPECT_EQ(Parsed(AddConnectionFlags, "").patience.connection, Patience().connection);
  const Patience given = Parsed(AddConnectionFlags, "--patience 7").patience;
  EXPECT_EQ(given.connection, std::chrono::seconds(7));
  EXPECT_EQ(given.calls, std::chrono::seconds(7));
  ::setenv("TESSERA_COORDINATOR", "unix:/farm", 1);
  EXPECT_EQ(Parsed(AddConnectionFlags, "").farm.coordinator, "unix:/farm");
  EXPECT_EQ(Parsed(AddConnectionFlags, "--coordinator farm:99").farm.coordinator, "farm:99");
  ::unsetenv("TESSERA_COORDINATOR");
  ::setenv("TESSERA_FARM", "studio", 1);
  EXPECT_EQ(Parsed(AddConnectionFlags, "").farm.farm, "studio");
  EXPECT_EQ(Parsed(AddConnectionFlags, "--farm home").farm.farm, "home");
  ::unsetenv("TESSERA_FARM");
  EXPECT_TRUE(Parsed(AddConnectionFlags, "--insecure").farm.insecure);
}

TEST(VerifyFlag, IsAPercentageWithOrWithoutItsSign) {
  EXPECT_DOUBLE_EQ(Parsed(AddVerifyFlag, "--verify 2.5%"), 0.025);
  EXPECT_DOUBLE_EQ(Parsed(AddVerifyFlag, "--verify 100"), 1);
}

TEST(CommandLine, AcceptsEveryCommandWithItsFlags) {
  for (const char* words :
       {"render s.pbrt -o o.exr --png o.png --workers 3 --threads 2 --in-process --spp 64 --json",
        "render s.pbrt --verify 5% --workers 2",
        "info s.pbrt --accelerator bvh --json",
        "kinds --json",
        "compare a.exr b.exr --tolerance 0.5 --layer albedo --difference d.png --json",
        "denoise a.exr -o b.exr --png b.png --exr-type float --threads 2 --denoiser oidn --json",
        "denoise a.####.exr --frames 1-8 -o b.exr --no-temporal",
        "submit s.pbrt --coordinator farm:99 --name film --priority -4 --watch --spp 8 --json",
        "submit s.pbrt --require gpu --require linux-6 --verify 2.5%",
        "fetch 12 --preview -o a.exr --png a.png --frame 3 --json",
        "status 1 --json",
        "watch 1 --patience 3",
        "cancel 1",
        "pause 1",
        "resume 1",
        "priority 12 -4",
        "extend 3 --spp 64",
        "jobs --json",
        "workers",
        "drain blade-7",
        "release blade-7",
        "watch 3 4 5 --json",
        "render s.pbrt --no-clobber",
        "render s.pbrt --dry-run --json",
        "submit s.pbrt --dry-run",
        "submit s.pbrt --watch --notify-command true"}) {
    const auto parsed = Parse(words);
    ASSERT_TRUE(parsed) << words << ": " << parsed.error().message;
    EXPECT_TRUE(parsed->run) << words;
  }
}

TEST(CommandLine, RefusesBadWordsAndNamesWhatIsExpected) {
  const struct {
    const char* words;
    const char* message;
  } cases[] = {
      {"", "no command"},
      {"rendr s.pbrt", "unknown command \"rendr\" (did you mean \"render\"?)"},
      {"render", "SCENE is required"},
      {"render s.pbrt --sp 3", "render: unknown flag \"--sp\" (did you mean \"--spp\"?)"},
      {"render s.pbrt --outfile a.exr", "unknown flag \"--outfile\"; pbrt's --outfile is -o FILE here"},
      {"submit s.pbrt --pixelmaterial=3,4", "; pbrt's --pixelmaterial is --aov crypto_material here"},
      {"render s.pbrt --mse-reference-image a.exr", "\"tessera compare\" measures the error of a picture"},
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
      {"cancel", "JOB is required"},
      {"status soon", "JOB: \"soon\""},
      {"status 0", "JOB: \"0\""},
      {"compare a.exr", "B is required"},
      {"compare a.exr b.exr --tolerance -1", "--tolerance: \"-1\""},
      {"compare a.exr b.exr --difference d.exr", "--difference: \"d.exr\" does not end in .png"},
      {"compare a.exr b.exr --difference -", "--difference: write to a file"},
      {"submit s.pbrt --priority 1000001", "--priority"},
      {"extend 3", "--spp is required"},
      {"extend 3 --spp 0", "--spp: \"0\""},
      {"priority 3", "N is required"},
      {"priority 3 high", "N: \"high\" is not a whole number from -1000000 to 1000000"},
      {"submit s.pbrt --require two,words", "--require: \"two,words\" is not a word"},
      {"submit s.pbrt --verify 101%", "--verify: \"101%\" is not a percentage from 0% to 100%"},
      {"submit s.pbrt --verify some", "--verify: \"some\""},
      {"submit s.pbrt --verify nan", "--verify: \"nan\""},
      {"drain", "WORKER is required"},
      {"pause", "JOB is required"},
      {"watch 1 soon", "JOB: \"soon\""},
      {"submit s.pbrt --notify-command true", "--notify-command needs --watch"},
      {"render s.pbrt --verify 5% --in-process", "--verify needs at least two workers"},
      {"render s.pbrt --verify 5% --workers 1", "--verify needs at least two workers"},
  };
  for (const auto& bad : cases) {
    const auto parsed = Parse(bad.words);
    ASSERT_FALSE(parsed) << bad.words;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kBadInput) << bad.words;
    EXPECT_THAT(parsed.error().message, HasSubstr(bad.message)) << bad.words;
  }
}

TEST(CommandLine, TakesArgumentsThatHaveTheNameOfACommand) {
  EXPECT_TRUE(Parse("info render"));
  EXPECT_TRUE(Parse("man fetch"));
  EXPECT_TRUE(Parse("compare jobs workers --json"));
}

TEST(CommandLine, RefusesNumbersOfCryptomatteLevelsBeyondTheirLimits) {
  const std::pair<const char*, const char*> cases[] = {
      {"render s.pbrt --cryptomatte-levels 0",
       "--cryptomatte-levels: \"0\" is not a whole number from 1 to 8"},
      {"submit s.pbrt --cryptomatte-levels 9", "--cryptomatte-levels: \"9\""},
      {"render s.pbrt --cryptomatte-levels -1", "--cryptomatte-levels: \"-1\""},
      {"render s.pbrt --cryptomatte-levels 4294967299", "--cryptomatte-levels: \"4294967299\""},
  };
  for (const auto& [words, message] : cases) {
    const auto parsed = Parse(words);
    ASSERT_FALSE(parsed) << words;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kBadInput) << words;
    EXPECT_THAT(parsed.error().message, HasSubstr(message)) << words;
  }
}

TEST(CommandLine, RefusesWordsThatDenoiseCannotUse) {
  const std::pair<const char*, const char*> cases[] = {
      {"denoise", "PICTURE is required"},
      {"denoise a.exr --frames 1-8", "a.exr: the name of a sequence has ####"},
      {"denoise a.exr --exr-type double", "--exr-type: \"double\""},
      {"denoise a.exr --threads 0", "--threads"},
      {"denoise a.exr --denoiser none", "--denoiser: \"none\" is not one of regression, oidn"},
      {"render s.pbrt --denoiser oidm", "(did you mean \"oidn\"?)"},
      {"denoise a.exr -o - --json", "the standard output cannot take both"},
  };
  for (const auto& [words, message] : cases) {
    const auto parsed = Parse(words);
    ASSERT_FALSE(parsed) << words;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kBadInput) << words;
    EXPECT_THAT(parsed.error().message, HasSubstr(message)) << words;
  }
}

TEST(CommandLine, RefusesNumbersThatAreNone) {
  const std::pair<const char*, std::vector<const char*>> flags[] = {
      {"render s.pbrt",
       {"--fps", "--spp", "--noise-threshold", "--seed", "--max-depth", "--resolution", "--crop",
        "--pixelbounds", "--displacement-edge-scale", "--tile-size", "--workers", "--threads", "--verify"}},
      {"submit s.pbrt", {"--priority", "--patience", "--verify"}},
      {"fetch 1", {"--frame", "--patience"}},
      {"extend 1", {"--spp"}},
      {"compare a.exr b.exr", {"--tolerance"}},
  };
  for (const auto& [command, names] : flags) {
    for (const char* flag : names) {
      for (const char* word :
           {"nan", "inf", "-inf", "1e400", "0x10", "-99999999999999999999999", "99999999999999999999999"}) {
        const bool is_double = std::string_view(flag) == "--fps" || std::string_view(flag) == "--tolerance";
        if (is_double && std::string_view(word) == "99999999999999999999999") continue;
        const auto parsed = Parse(fmt::format("{} {}={}", command, flag, word));
        ASSERT_FALSE(parsed) << flag << " " << word;
        EXPECT_EQ(parsed.error().kind, ErrorKind::kBadInput);
        EXPECT_THAT(parsed.error().message, HasSubstr(flag)) << word;
      }
    }
  }
}

TEST(CommandLine, AnswersHelpAndVersion) {
  EXPECT_THAT(Parse("--help")->answer, HasSubstr("Pause a job"));
  EXPECT_THAT(Parse("render --help")->answer, HasSubstr("Usage: tessera render [OPTIONS] SCENE"));
  EXPECT_THAT(Parse("render --help")->answer, HasSubstr("--spp"));
  EXPECT_THAT(Parse("render --help")->answer, testing::Not(HasSubstr("--camera")));
  EXPECT_THAT(Parse("--version")->answer, HasSubstr("tessera "));
}

TEST(CommandLine, ListsEveryCommandWithASummaryInTheImperative) {
  const std::string help = Parse("--help")->answer;
  for (const MakeCommandFunction make : kCommands) {
    const Command command = make();
    EXPECT_THAT(help, HasSubstr("  " + command.name + " "));
    EXPECT_THAT(help, HasSubstr(command.summary));
    EXPECT_TRUE(std::isupper(static_cast<unsigned char>(command.summary.at(0)))) << command.summary;
    EXPECT_FALSE(command.summary.ends_with('.')) << command.summary;
  }
}

}  // namespace
}  // namespace tessera
