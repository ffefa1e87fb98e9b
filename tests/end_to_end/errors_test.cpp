// Bad input is reported in one line, before anything starts, with the exit code of the contract.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>

#include "tests/end_to_end/farm_fixture.h"
#include "tests/renderer/exr_bytes.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class Errors : public EndToEnd {
 protected:
  // A scene whose world holds `world`.
  std::string Scene(const std::string& world) const {
    return Write("scene.pbrt", "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n" + world);
  }
  // Expects that a farm and a render in one process refuse the arguments in one line and leave no files.
  void ExpectBadInput(const std::vector<std::string>& words, const std::string& message) {
    for (const char* way : {"--in-process", "--workers=1"}) {
      std::vector<std::string> arguments{"render", way};
      arguments.insert(arguments.end(), words.begin(), words.end());
      const Outcome outcome = Tessera(arguments);
      EXPECT_EQ(outcome.code, 2) << outcome.errors;
      EXPECT_THAT(outcome.errors, HasSubstr(message));
      EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
      EXPECT_EQ(outcome.output, "");
    }
    EXPECT_FALSE(Exists("scene.exr"));
    EXPECT_TRUE(std::filesystem::is_empty(Path("tmp")));
  }
};

TEST_F(Errors, ATruncatedPlyFileIsNamed) {
  Write("half.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n");
  ExpectBadInput({Scene("Shape \"plymesh\" \"string filename\" \"half.ply\"\n")}, "half.ply");
}

TEST_F(Errors, AMissingTextureIsNamed) {
  ExpectBadInput({Scene("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"gone.png\"\n"
                        "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n")},
                 "gone.png");
}

TEST_F(Errors, AnUnknownMaterialIsReportedWithItsLocation) {
  ExpectBadInput({Scene("Material \"chrome\"\nShape \"sphere\"\n")}, "scene.pbrt:4:");
}

TEST_F(Errors, ASyntaxErrorInAnIncludedFileIsLocatedThere) {
  Write("part.pbrt", "Material \"diffuse\"\nShape \"sphere\" \"float radius\" [ one ]\n");
  ExpectBadInput({Scene("Include \"part.pbrt\"\n")}, "part.pbrt:");
}

TEST_F(Errors, ANegativeResolutionIsRefusedInTheSceneAndOnTheCommandLine) {
  const std::string scene = Write(
      "scene.pbrt",
      "Film \"rgb\" \"integer xresolution\" -5\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n");
  ExpectBadInput({scene}, "scene.pbrt:1:");
  ExpectBadInput({Scene("Shape \"sphere\"\n"), "--resolution", "-5x10"}, "--resolution: \"-5x10\"");
}

TEST_F(Errors, AnOutputFolderThatDoesNotExistIsFoundBeforeRendering) {
  ExpectBadInput({BoxScene(), "-o", "nowhere/picture.exr"}, "the folder nowhere does not exist");
  ExpectBadInput({BoxScene(), "--png", "nowhere/picture.png"}, "the folder nowhere does not exist");
  ExpectBadInput({BoxScene(), "-o", "tmp"}, "tmp: is a folder");
}

TEST_F(Errors, AMissingSceneIsNamed) {
  ExpectBadInput({Path("gone.pbrt")}, "gone.pbrt");
}

TEST_F(Errors, APipeInPlaceOfASceneIsRefusedAtOnce) {
  const Outcome outcome = RunShell(folder(), "mkfifo pipe; timeout 60 $tessera info pipe");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.errors, "tessera: pipe: is not a regular file\n");
  ExpectBadInput({"pipe"}, "pipe: is not a regular file");
}

TEST_F(Errors, OfStandardInputThatIsNoSceneTheRestIsNotRead) {
  const std::string endless = "cat /dev/zero) | timeout 60 ";
  const std::vector<std::pair<std::string, std::string>> starts = {
      {"(", "<stdin>:1:1: zero byte, expected text"},
      {"(printf 'WorldBegin # 0\\nShape'; ", "<stdin>:2:1: zero byte, expected text"},
      {"(printf 'Camera \"'; ", "<stdin>:1:8: zero byte in a string"},
      {"(printf '\\xff\\xfe'; ", "<stdin>:1:1: the file is UTF-16, expected UTF-8"}};
  for (const auto& [start, message] : starts) {
    for (const std::string command : {"$tessera info -", "$tessera render - --in-process"}) {
      const Outcome outcome = RunShell(folder(), start + endless + command);
      EXPECT_EQ(outcome.code, 2) << start;
      EXPECT_THAT(outcome.errors, HasSubstr(message)) << start;
    }
  }
  const Outcome comment =
      RunShell(folder(), "(echo WorldBegin; printf '# \\0\\nNonsense') | $tessera info -");
  EXPECT_THAT(comment.errors, HasSubstr("<stdin>:3:1: ")) << "a comment may hold any byte";
}

TEST_F(Errors, SubmitRefusesABadSceneBeforeItConnects) {
  const Outcome outcome = Tessera({"submit", Scene("Material \"chrome\"\n"), "--coordinator", "127.0.0.1:1"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("scene.pbrt:4:"));
}

TEST_F(Errors, ACoordinatorFailsIfItsPortIsInUse) {
  StartCoordinator();
  const Outcome second =
      RunProgram(folder(), "tessera-coordinator", {"--listen", address(), "--data-dir", Path("other")});
  EXPECT_EQ(second.code, 1);
  EXPECT_THAT(second.errors, HasSubstr(address()));
}

TEST_F(Errors, AnUnreachableCoordinatorIsAFailureNotBadInput) {
  StartCoordinator();
  coordinator().Signal(SIGKILL);
  coordinator().Wait();
  const Outcome outcome = Ask({"jobs", "--patience", "2"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("waiting for it up to 2 s"));
  EXPECT_THAT(outcome.errors, HasSubstr(address() + ": no coordinator answered within 2 s"));
}

TEST_F(Errors, ACoordinatorRefusesPlainTextOnPublicAddresses) {
  const Outcome outcome = RunProgram(folder(), "tessera-coordinator",
                                     {"--listen", "0.0.0.0:0", "--insecure", "--data-dir", Path("data")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("--insecure"));
}

TEST_F(Errors, AWorkerNamesItsBadOptions) {
  const auto expect = [&](const std::vector<std::string>& words, const std::string& message) {
    const Outcome outcome = RunProgram(folder(), "tessera-worker", words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.errors, HasSubstr(message));
  };
  expect({}, "--coordinator");
  expect({"--coordinator", "nonsense"}, "nonsense");
  expect({"--coordinator", "127.0.0.1:1", "--threads", "0"}, "--threads: \"0\"");
  expect({"--coordinator", "127.0.0.1:1", "--cache-size", "3X"}, "--cache-size: \"3X\"");
  expect({"--coordinator", "127.0.0.1:1", "--thread", "2"}, "did you mean \"--threads\"?");
  expect({"--coordinator", "127.0.0.1:1", "--cache-dir", "/proc/nothing"}, "--cache-dir");
}

// OpenEXR would allocate 1.8 GB for the attribute.
TEST_F(Errors, ComparingAPictureWhoseHeaderAnnouncesMoreThanTheFileHoldsIsRefused) {
  const std::string claim =
      std::string("claim") + '\0' + "string" + '\0' + LittleEndian32(0x70000000) + "abc";
  const std::string path = Write("hostile.exr", ExrHeader(2, 2, "BGR", claim) + std::string(64, '\0'));
  const Outcome outcome = Tessera({"compare", path, path});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("hostile.exr: damaged OpenEXR picture: the attribute \"claim\" has"));
  EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
  EXPECT_EQ(outcome.output, "");
}

}  // namespace
}  // namespace tessera
