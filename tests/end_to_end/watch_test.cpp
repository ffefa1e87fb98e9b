// Several jobs are watched together.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

using WatchSeveral = EndToEnd;

TEST_F(WatchSeveral, UntilAllHaveEnded) {
  StartCoordinator();
  StartWorker("one", 1);
  const std::string first = Submit(BoxScene(), {"--spp", "1"}), second = Submit(BoxScene(), {"--spp", "2"});
  const Outcome outcome =
      Ask({"watch", first, second, "--notify-command", "echo \"ended $TESSERA_JOB_ID\" >&2"});
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("job " + first + " "));
  EXPECT_THAT(outcome.output, HasSubstr("job " + second + " "));
  EXPECT_EQ(std::ranges::count(outcome.output, '\n'), 2);
  EXPECT_THAT(outcome.errors, HasSubstr("ended " + first));
  EXPECT_THAT(outcome.errors, HasSubstr("ended " + second));
}

TEST_F(WatchSeveral, AJobThatWasCancelledIsAFailure) {
  StartCoordinator();
  const std::string first = Submit(BoxScene(), {"--spp", "1"}), second = Submit(BoxScene(), {"--spp", "2"});
  Ask({"cancel", second});
  Ask({"cancel", first});
  const Outcome outcome = Ask({"watch", first, second});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("was cancelled"));
  EXPECT_EQ(Ask({"watch", first, "999"}).code, 2) << "there is no such job";
}

}  // namespace
}  // namespace tessera
