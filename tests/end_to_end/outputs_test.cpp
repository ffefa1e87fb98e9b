// What commands read, where they write, and in which format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Outputs : public EndToEnd {
 protected:
  // A small scene whose world holds `rest` as well.
  static std::string Scene(const std::string& rest = "") {
    return "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 8 Sampler \"independent\" "
           "\"integer pixelsamples\" 1\nLookAt 0 0 -4 0 0 0 0 1 0 Camera \"perspective\"\nWorldBegin\n"
           "LightSource \"infinite\"\nShape \"sphere\"\n" +
           rest;
  }
  void ExpectRefused(std::vector<std::string> arguments, const std::string& message) const {
    const Outcome outcome = Tessera(arguments);
    EXPECT_EQ(outcome.code, 2) << testing::PrintToString(arguments) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr(message)) << testing::PrintToString(arguments);
  }
};

TEST_F(Outputs, TheSceneOfATypedPathIsNotSearchedForElsewhere) {
  Write("scene.pbrt", Scene());
  Write("scene.0001.pbrt", Scene());
  for (const char* folder : {"typo/", "shots/typo/"}) {
    const std::string scene = folder + std::string("scene.pbrt");
    ExpectRefused({"render", scene, "--in-process"}, scene + ": cannot be opened");
    ExpectRefused({"render", scene, "--workers=1"}, scene + ": cannot be opened");
    ExpectRefused({"info", scene}, scene + ": cannot be opened");
    ExpectRefused({"submit", scene, "--coordinator", "127.0.0.1:1"}, scene + ": cannot be opened");
    ExpectRefused({"render", folder + std::string("scene.####.pbrt"), "--frames", "1", "--in-process"},
                  std::string(folder) + "scene.0001.pbrt: cannot be opened");
  }
}

TEST_F(Outputs, InputsAreNeverOverwritten) {
  Write("sunset.pbrt", Scene("Include \"part.pbrt\"\nTexture \"t\" \"spectrum\" \"imagemap\" "
                             "\"string filename\" \"sunset.exr\"\n"
                             "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n"));
  Write("part.pbrt", "Shape \"sphere\"\n");
  Write("plain.pbrt", Scene());
  ASSERT_EQ(Tessera({"render", "plain.pbrt", "-o", "sunset.exr", "--in-process"}).code, 0);
  const std::string texture = Bytes("sunset.exr"), scene = Bytes("sunset.pbrt");
  fs::create_symlink("sunset.exr", Path("link.exr"));
  fs::create_symlink("part.pbrt", Path("part.exr"));
  fs::create_hard_link(Path("sunset.pbrt"), Path("hard.exr"));
  for (const char* way : {"--in-process", "--workers=1"}) {
    ExpectRefused({"render", "sunset.pbrt", way}, "sunset.exr: the command reads this file");
    for (const char* name : {"./sunset.exr", "link.exr", "part.exr", "hard.exr", "tmp/../sunset.exr"}) {
      ExpectRefused({"render", "sunset.pbrt", "-o", name, way}, "the command reads this file");
    }
    ExpectRefused({"render", "sunset.pbrt", "-o", "sunset.pbrt", way}, "cannot write pictures of type .pbrt");
    ExpectRefused({"render", "plain.pbrt", "-o", "a.png", "--png", "./a.png", way}, "two pictures");
    ExpectRefused({"render", "plain.pbrt", "-o", "a.exr", "--png", "a.exr", way}, "must end in .png");
  }
  EXPECT_EQ(Bytes("sunset.exr"), texture);
  EXPECT_EQ(Bytes("sunset.pbrt"), scene);
}

TEST_F(Outputs, NumberedFramesOverwriteNeitherInputsNorEachOther) {
  Write("walk.pbrt", Scene("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"walk.0002.exr\"\n"
                           "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n"));
  Write("plain.pbrt", Scene());
  ASSERT_EQ(Tessera({"render", "plain.pbrt", "-o", "walk.0002.exr", "--in-process"}).code, 0);
  ExpectRefused({"render", "walk.pbrt", "--frames", "1-3", "--in-process"},
                "walk.0002.exr: the command reads this file");
  EXPECT_FALSE(Exists("walk.0001.exr"));
  fs::create_symlink("out.0001.exr", Path("out.0002.exr"));
  ExpectRefused({"render", "plain.pbrt", "--frames", "1-2", "-o", "out.exr", "--in-process"},
                "two pictures would be written to this file");
}

TEST_F(Outputs, EveryCommandWritesThroughLinksAndKeepsModes) {
  Write("plain.pbrt", Scene());
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit("plain.pbrt", {});
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  const std::string expected = Oracle("plain.pbrt", {});
  const auto prepare = [&] {
    for (const char* name : {"real.exr", "real.png"}) {
      Write(name, "old");
      fs::permissions(Path(name), fs::perms(0600));
    }
    for (const char* name : {"link.exr", "link.png"}) {
      fs::remove(Path(name));
      fs::create_symlink("real" + fs::path(name).extension().string(), Path(name));
    }
  };
  const auto check = [&](const Outcome& outcome) {
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("real.exr") == expected);
    EXPECT_EQ(Bytes("real.png").substr(1, 3), "PNG");
    EXPECT_TRUE(fs::is_symlink(Path("link.exr")) && fs::is_symlink(Path("link.png")));
    EXPECT_EQ(fs::status(Path("real.exr")).permissions(), fs::perms(0600));
    EXPECT_EQ(fs::status(Path("real.png")).permissions(), fs::perms(0600));
  };
  for (const char* way : {"--in-process", "--workers=1"}) {
    prepare();
    check(Tessera({"render", "plain.pbrt", "-o", "link.exr", "--png", "link.png", way}));
  }
  prepare();
  check(Ask({"fetch", job, "-o", "link.exr", "--png", "link.png"}));
  fs::permissions(Path("real.exr"), fs::perms(0444));
  const Outcome refused = Ask({"fetch", job, "-o", "link.exr"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("link.exr: is read-only"));
}

TEST_F(Outputs, PipesAndDevicesAreWrittenTo) {
  Write("plain.pbrt", Scene());
  const std::string expected = Oracle("plain.pbrt", {});
  ASSERT_EQ(::mkfifo(Path("pipe.exr").c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = Bytes("pipe.exr"); });
  const Outcome piped = Tessera({"render", "plain.pbrt", "-o", "pipe.exr", "--in-process"});
  reader.join();
  EXPECT_EQ(piped.code, 0) << piped.errors;
  EXPECT_TRUE(read == expected);
  EXPECT_TRUE(fs::is_fifo(Path("pipe.exr")));
  EXPECT_EQ(Tessera({"render", "plain.pbrt", "-o", "/dev/null", "--in-process"}).code, 0);
  EXPECT_EQ(Tessera({"render", "plain.pbrt", "-o", "/dev/null", "--frames", "1-2", "--in-process"}).code, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_FALSE(fs::exists("/dev/null.0001"));
  const Outcome shown = Tessera({"render", "plain.pbrt", "-o", "/dev/stdout", "--in-process"});
  EXPECT_EQ(shown.code, 0) << shown.errors;
  EXPECT_TRUE(shown.output == expected);
  ExpectRefused({"render", "plain.pbrt", "-o", "/dev/stdout", "--json"}, "--json");
}

TEST_F(Outputs, ADashIsTheStandardOutput) {
  Write("plain.pbrt", Scene());
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit("plain.pbrt", {});
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  const std::string exr = Oracle("plain.pbrt", {});
  ASSERT_EQ(Ask({"fetch", job, "-o", "a.png"}).code, 0);
  const std::string png = Bytes("a.png");
  // A file of this name is another one. It holds what the command would write.
  Write("-", exr);
  const auto expect = [](const Outcome& outcome, const std::string& picture) {
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(outcome.output == picture);
  };
  for (const char* way : {"--in-process", "--workers=1"}) {
    const Outcome rendered = Tessera({"render", "plain.pbrt", "-o", "-", way});
    expect(rendered, exr);
    EXPECT_THAT(rendered.errors, HasSubstr("the standard output: rendered"));
  }
  expect(Tessera({"render", "plain.pbrt", "-o", "b.exr", "--png", "-", "--in-process"}), png);
  EXPECT_TRUE(Bytes("b.exr") == exr);
  expect(Ask({"fetch", job, "-o", "-"}), exr);
  expect(Ask({"fetch", job, "-o", "c.exr", "--png", "-"}), png);
  EXPECT_TRUE(Bytes("-") == exr);
  ASSERT_EQ(Ask({"fetch", job, "-o", "./-", "--png", "d.png"}).code, 0);
  EXPECT_TRUE(Bytes("-") == exr);
}

TEST_F(Outputs, TheStandardOutputTakesOnePictureAndNothingElse) {
  Write("plain.pbrt", Scene());
  const std::vector<std::string> render{"render", "plain.pbrt", "--in-process"};
  const auto refused = [&](std::vector<std::string> options, const std::string& message) {
    options.insert(options.begin(), render.begin(), render.end());
    ExpectRefused(options, message);
  };
  refused({"-o", "-", "--json"}, "--json");
  refused({"-o", "a.exr", "--png", "-", "--json"}, "--json");
  refused({"-o", "-", "--png", "-"}, "the standard output: two pictures");
  refused({"-o", "-", "--png", "/dev/stdout"}, "two pictures");
  refused({"-o", "-", "--frames", "1-2"}, "the standard output: two pictures");
  EXPECT_FALSE(Exists("a.exr"));
  // One frame is one picture.
  const auto frame = [&](const char* output) {
    return Tessera({"render", "plain.pbrt", "-o", output, "--frames", "3", "--in-process"});
  };
  const Outcome one = frame("-");
  EXPECT_EQ(one.code, 0) << one.errors;
  EXPECT_EQ(frame("a.exr").code, 0);
  EXPECT_TRUE(one.output == Bytes("a.0003.exr"));
}

TEST_F(Outputs, ATerminalOrAClosedPipeOnTheStandardOutputIsAnError) {
  Write("plain.pbrt", Scene());
  // script(1) runs a command on a new terminal.
  for (const char* name : {"-", "/dev/stdout"}) {
    const Outcome terminal = RunShell(
        folder(),
        "export tessera; script --quiet --return --command '$tessera render plain.pbrt --in-process -o " +
            std::string(name) + "' /dev/null </dev/null");
    EXPECT_EQ(terminal.code, 2) << terminal.output << terminal.errors;
    EXPECT_THAT(terminal.output, HasSubstr("is a terminal"));
  }
  // Descriptor 4 writes to a pipe whose reader is gone.
  const std::string closed_pipe = "mkfifo pipe; exec 3<>pipe 4>pipe 3<&-; $tessera render plain.pbrt ";
  for (const char* way : {"--in-process", "--workers=1"}) {
    std::filesystem::remove(Path("pipe"));
    const Outcome closed = RunShell(folder(), closed_pipe + way + " -o - >&4 4>&-");
    EXPECT_EQ(closed.code, 1) << closed.errors;
    EXPECT_THAT(closed.errors, HasSubstr("the standard output: cannot be written: Broken pipe"));
  }
}

TEST_F(Outputs, TheEndingChoosesTheFormat) {
  Write("plain.pbrt", Scene());
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit("plain.pbrt", {});
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  const std::pair<const char*, std::string> formats[] = {
      {".png", "\x89PNG"}, {".jpg", "\xff\xd8\xff"}, {".jpeg", "\xff\xd8\xff"}, {".tif", "II*"},
      {".tiff", "II*"},    {".hdr", "#?RADIANCE"},   {".pfm", "PF\n"},          {".EXR", "\x76\x2f\x31\x01"}};
  for (const auto& [ending, start] : formats) {
    const std::string here = "here" + std::string(ending), farm = "farm" + std::string(ending),
                      fetched = "fetched" + std::string(ending);
    EXPECT_EQ(Tessera({"render", "plain.pbrt", "-o", here, "--in-process"}).code, 0);
    EXPECT_EQ(Tessera({"render", "plain.pbrt", "-o", farm, "--workers=1"}).code, 0);
    EXPECT_EQ(Ask({"fetch", job, "-o", fetched}).code, 0);
    EXPECT_EQ(Bytes(here).substr(0, start.size()), start) << ending;
    EXPECT_TRUE(Bytes(farm) == Bytes(here)) << ending;
    EXPECT_TRUE(Bytes(fetched) == Bytes(here)) << ending;
  }
  for (const char* name : {"p.gif", "p.bmp", "p.exr2", "p.pbrt"}) {
    ExpectRefused({"render", "plain.pbrt", "-o", name, "--in-process"}, "cannot write pictures of type");
    const Outcome fetched = Ask({"fetch", job, "-o", name});
    EXPECT_EQ(fetched.code, 2) << fetched.errors;
    EXPECT_FALSE(Exists(name));
  }
  ExpectRefused({"render", "plain.pbrt", "-o", "p.png", "--aov", "samples"}, "--aov");
}

}  // namespace
}  // namespace tessera
