// What the client writes onto a disk that is full: nothing good is lost, and the message names the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/end_to_end/farm_fixture.h"
#include "tests/small_disk.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class FullDisk : public EndToEnd {
 protected:
  std::string LitScene() const {
    return Write(
        "lit.pbrt",
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n"
        "LookAt 0 1 -4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40\n"
        "Sampler \"independent\" \"integer pixelsamples\" 2\nWorldBegin\n"
        "LightSource \"infinite\" \"string group\" \"sky\"\n"
        "LightSource \"point\" \"point3 from\" [ 2 3 -2 ] \"rgb I\" [ 9 9 9 ] \"string group\" \"key\"\n"
        "Material \"diffuse\" Shape \"sphere\"\n");
  }
  // The names of the files in a folder.
  std::set<std::string> FilesIn(const std::string& name) const {
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(Path(name)))
      files.insert(entry.path().filename().string());
    return files;
  }
};

TEST_F(FullDisk, RelightKeepsThePictureThatItWouldReplace) {
  const std::string scene = LitScene();
  ASSERT_EQ(Tessera({"render", scene, "-o", "lit.exr", "--in-process", "--aov", "light_groups"}).code, 0);
  const SmallDisk disk(Path("small"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  ASSERT_EQ(Tessera({"relight", "lit.exr", "-o", "small/mixed.exr", "--gain", "key=2"}).code, 0);
  const std::string before = Bytes("small/mixed.exr");
  disk.Fill();
  for (const std::string output : {"small/mixed.exr", "small/new.exr"}) {
    const Outcome refused = Tessera({"relight", "lit.exr", "-o", output, "--gain", "key=3"});
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.errors, AllOf(HasSubstr(output), HasSubstr("No space left")));
  }
  EXPECT_EQ(FilesIn("small"), (std::set<std::string>{"filler", "mixed.exr"}));
  EXPECT_TRUE(Bytes("small/mixed.exr") == before);
  disk.Free();
  EXPECT_EQ(Tessera({"relight", "lit.exr", "-o", "small/mixed.exr", "--gain", "key=3"}).code, 0);
  EXPECT_FALSE(Bytes("small/mixed.exr") == before);
}

TEST_F(FullDisk, ARenderedPictureThatCannotBeWrittenIsKeptElsewhere) {
  const SmallDisk disk(Path("small"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  disk.Fill();
  const std::string oracle = Oracle(LitScene(), {});
  std::filesystem::create_directory(Path("temporary"));
  for (const std::string mode : {"--in-process", "--workers 1"}) {
    const Outcome outcome = RunShell(folder(), "TMPDIR=" + Path("temporary") + " $tessera render " +
                                                   LitScene() + " -o small/p.exr " + mode);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.errors,
                AllOf(HasSubstr("small/p.exr: cannot be written: No space left"),
                      HasSubstr("; the picture is kept as " + Path("temporary/tessera-rescued-"))));
    const std::set<std::string> kept = FilesIn("temporary");
    ASSERT_EQ(kept.size(), 1u) << mode;
    EXPECT_TRUE(Bytes("temporary/" + *kept.begin() + "/p.exr") == oracle) << mode;
    std::filesystem::remove_all(Path("temporary/" + *kept.begin()));
  }
}

TEST_F(FullDisk, AnAnswerThatCannotBeWrittenIsAnError) {
  for (const std::string command : {"kinds --json >/dev/full", "--version >/dev/full", "--version >&-"}) {
    const Outcome outcome = RunShell(folder(), "$tessera " + command);
    EXPECT_EQ(outcome.code, 1) << command;
    EXPECT_THAT(outcome.errors, HasSubstr("the standard output: cannot be written")) << command;
  }
  EXPECT_EQ(RunShell(folder(), "$tessera kinds | head -n 1 >/dev/null; exit ${PIPESTATUS[0]}").code, 0);
}

TEST_F(FullDisk, AFileBeyondTheLimitOfSizesIsAnError) {
  const Outcome outcome =
      RunShell(folder(), "ulimit -f 1; $tessera render " + LitScene() + " --in-process -o p.exr");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("p.exr: cannot be written: File too large"));
  EXPECT_FALSE(std::filesystem::exists(Path("p.exr")));
}

TEST_F(FullDisk, FilesOfSingleLayersAreReplacedByWholeOnesOnly) {
  const SmallDisk disk(Path("small"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  const std::vector<std::string> render{"render",       LitScene(),     "-o",
                                        "small/p.exr",  "--in-process", "--aov",
                                        "albedo,depth", "--aov-split",  "--seed"};
  const auto with_seed = [&](const char* seed) {
    std::vector<std::string> words = render;
    words.emplace_back(seed);
    return words;
  };
  ASSERT_EQ(Tessera(with_seed("1")).code, 0);
  const std::set<std::string> files{"p.exr", "p.albedo.exr", "p.depth.exr"};
  ASSERT_EQ(FilesIn("small"), files);
  std::vector<std::string> before;
  for (const std::string& file : files) before.push_back(Bytes("small/" + file));
  disk.Fill();
  const Outcome refused = Tessera(with_seed("2"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.errors, AllOf(HasSubstr("small/p."), HasSubstr("No space left")));
  disk.Free();
  EXPECT_EQ(FilesIn("small"), files) << "no temporary files";
  size_t i = 0;
  for (const std::string& file : files) EXPECT_TRUE(Bytes("small/" + file) == before[i++]) << file;
}

class FullDiskOfResume : public FullDisk {
 protected:
  const std::vector<std::string> settings_{"--spp", std::to_string(400 / kSlowdown), "--tile-size", "16"};

  std::vector<std::string> Render(const std::string& output) const {
    std::vector<std::string> words{"render", BoxScene(), "-o", output, "--resume", "--threads", "1"};
    words.insert(words.end(), settings_.begin(), settings_.end());
    return words;
  }
};

TEST_F(FullDiskOfResume, ARenderContinuesWhenThereIsSpaceAgain) {
  const SmallDisk disk(Path("user-cache"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  const std::string oracle = Oracle(BoxScene(), settings_);
  Process render(folder(), "tessera", Render("a.exr"));
  // Results are kept, so the scene has been sent.
  ASSERT_TRUE(Eventually([&] { return BytesBelow("user-cache") > 50'000; })) << render.Errors();
  disk.Fill();
  ASSERT_TRUE(render.AwaitErrors("No space left")) << render.Errors();
  EXPECT_FALSE(Exists("a.exr"));
  disk.Free();
  EXPECT_EQ(render.Wait(), 0) << render.Errors();
  EXPECT_TRUE(Bytes("a.exr") == oracle);
}

TEST_F(FullDiskOfResume, APictureThatCannotBeWrittenIsNotRenderedAgain) {
  const SmallDisk disk(Path("small"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  const std::string oracle = Oracle(BoxScene(), settings_);
  disk.Fill();
  const Outcome refused = Tessera(Render("small/a.exr"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.errors, AllOf(HasSubstr("small/a.exr"), HasSubstr("No space left")));
  EXPECT_EQ(FilesIn("user-cache/tessera-renders").size(), 1u) << "what was rendered is kept";
  disk.Free();
  const Outcome again = Tessera(Render("small/a.exr"));
  EXPECT_EQ(again.code, 0) << again.errors;
  EXPECT_THAT(again.errors, HasSubstr("continuing what was interrupted"));
  EXPECT_TRUE(Bytes("small/a.exr") == oracle);
  EXPECT_TRUE(FilesIn("user-cache/tessera-renders").empty());
}

}  // namespace
}  // namespace tessera
