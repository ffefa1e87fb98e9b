// `tessera render --resume` continues what was interrupted.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

class Resume : public EndToEnd {
 protected:
  size_t KeptRenders() const {
    const std::string renders = Path("user-cache/tessera-renders");
    std::error_code error;
    const std::filesystem::directory_iterator entries(renders, error);
    return error ? 0 : static_cast<size_t>(std::distance(entries, std::filesystem::directory_iterator()));
  }
  uint64_t KeptBytes() const { return BytesBelow("user-cache"); }
};

TEST_F(Resume, ContinuesAfterAnInterruptionAndAKillWithTheSameBits) {
  // Several seconds of work, in small units.
  const std::vector<std::string> settings{"--spp", std::to_string(400 / kSlowdown), "--tile-size", "16"};
  std::vector<std::string> render{"render", BoxScene(), "-o", "a.exr", "--resume", "--threads", "1"};
  render.insert(render.end(), settings.begin(), settings.end());
  uint64_t kept = 0;
  for (const int signal : {SIGINT, SIGKILL}) {
    Process first(folder(), "tessera", render);
    ASSERT_TRUE(Eventually([&] { return KeptBytes() > kept + 50'000; })) << first.Errors();
    const std::vector<pid_t> children = ChildrenOf(first.pid());
    first.Signal(signal);
    ASSERT_TRUE(first.Wait());
    for (const pid_t each : children) ASSERT_TRUE(Eventually([each] { return !IsAlive(each); }));
    EXPECT_EQ(KeptRenders(), 1u);
    kept = KeptBytes();
    EXPECT_FALSE(Exists("a.exr"));
  }
  const Outcome last = Tessera(render);
  EXPECT_EQ(last.code, 0) << last.errors;
  EXPECT_THAT(last.errors, HasSubstr("continuing what was interrupted"));
  EXPECT_EQ(KeptRenders(), 0u) << "nothing is left to continue";
  EXPECT_EQ(Bytes("a.exr"), Oracle(BoxScene(), settings));
}

TEST_F(Resume, OtherSettingsAreAnotherPicture) {
  Process first(folder(), "tessera", {"render", BoxScene(), "--spp", "100000", "-o", "a.exr", "--resume"});
  ASSERT_TRUE(first.AwaitErrors("samples/s")) << first.Errors();
  const Outcome same = Tessera({"render", BoxScene(), "--spp", "100000", "-o", "c.exr", "--resume"});
  EXPECT_EQ(same.code, 1);
  EXPECT_THAT(same.errors, HasSubstr("another process renders this scene"));
  const Outcome other = Tessera({"render", BoxScene(), "--spp", "1", "-o", "b.exr", "--resume"});
  EXPECT_EQ(other.code, 0) << other.errors;
  EXPECT_THAT(other.errors, Not(HasSubstr("continuing")));
}

}  // namespace
}  // namespace tessera
