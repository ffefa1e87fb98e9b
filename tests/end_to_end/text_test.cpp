// Text from outside: names that are not UTF-8, that try to be something else, or that are too long.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kLatin1 = "caf\xe9";
const std::string kClean = "caf\xef\xbf\xbd";

class TextFromOutside : public EndToEnd {
 protected:
  static std::string Scene(const std::string& world) {
    return "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 8 Camera \"perspective\"\n"
           "WorldBegin\nLightSource \"infinite\"\n" +
           world;
  }
};

TEST_F(TextFromOutside, FilesWhoseNamesAreNotUtf8RenderOnFarms) {
  Write(kLatin1 + ".pbrt", Scene("Include \"part.pbrt\"\n"));
  Write("part.pbrt", "Translate 0 0 4 Shape \"sphere\"\n");
  const std::string expected = Oracle(kLatin1 + ".pbrt", {"--spp", "2"});
  const Outcome local = Tessera({"render", kLatin1 + ".pbrt", "--spp", "2", "--workers=1"});
  EXPECT_EQ(local.code, 0) << local.errors;
  EXPECT_TRUE(Bytes(kLatin1 + ".exr") == expected);
  StartCoordinator();
  StartWorker(kLatin1);
  const Outcome job = Ask({"submit", kLatin1 + ".pbrt", "--spp", "2", "--watch"});
  ASSERT_EQ(job.code, 0) << job.errors;
  EXPECT_THAT(Ask({"jobs"}).output, HasSubstr(kClean));
  EXPECT_THAT(Ask({"workers", "--json"}).output, HasSubstr("\"name\":\"" + kClean + "\""));
  EXPECT_EQ(Ask({"drain", kLatin1}).code, 0) << "the name that was given to the worker";
  EXPECT_EQ(Ask({"release", kClean}).code, 0) << "the name that is shown";
  EXPECT_EQ(Ask({"fetch", "1", "-o", "p.exr"}).code, 0);
  EXPECT_TRUE(Bytes("p.exr") == expected);
}

TEST_F(TextFromOutside, AJobMayHaveAnyNameButForgesNoLogLine) {
  Write("scene.pbrt", Scene("Shape \"sphere\"\n"));
  StartCoordinator();
  StartWorker("only");
  const std::string forged = "x\" priority=9\njob_ended job=7 state=failed reason=\"\\";
  for (const std::string& name : {forged, kLatin1,
                                  std::string("a\xe2\x80\xae"
                                              "b\xc2\x9b"
                                              "31m"),
                                  "x" + std::string(100'000, 'y'), std::string("e\xcc\x81")}) {
    const Outcome job = Ask({"submit", "scene.pbrt", "--spp", "1", "--watch", "--name", name});
    EXPECT_EQ(job.code, 0) << job.errors;
  }
  const std::string log = coordinator().Errors();
  EXPECT_THAT(log, Not(HasSubstr("\njob_ended job=7")));
  EXPECT_THAT(log,
              HasSubstr("name=\"x\\\" priority=9 job_ended job=7 state=failed reason=\\\"\\\\\" owner="));
  for (const std::string& text : {log, Ask({"jobs"}).output, Ask({"jobs", "--json"}).output}) {
    EXPECT_THAT(text, Not(HasSubstr("\xe2\x80\xae")));
    EXPECT_THAT(text, Not(HasSubstr("\xc2\x9b")));
    EXPECT_THAT(text, Not(HasSubstr("\xe9")));
    EXPECT_THAT(text, Not(HasSubstr(std::string(300, 'y'))));
  }
}

TEST_F(TextFromOutside, MessagesOfAHostileSceneShowNoControlCharacters) {
  Write("scene.pbrt", Scene("NamedMaterial \"a\x1b]0;title\x07\xe2\x80\xae\xff\" Shape \"sphere\"\n"));
  for (const char* way : {"--in-process", "--workers=1"}) {
    const Outcome outcome = Tessera({"render", "scene.pbrt", way});
    EXPECT_EQ(outcome.code, 2) << outcome.errors;
    for (const char* hidden : {"\x1b", "\x07", "\xe2\x80\xae", "\xff"})
      EXPECT_THAT(outcome.errors, Not(HasSubstr(hidden)));
  }
}

}  // namespace
}  // namespace tessera
