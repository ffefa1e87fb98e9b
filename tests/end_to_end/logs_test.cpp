// The log of a job.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using Logs = EndToEnd;

TEST_F(Logs, PrintWhatHappenedAndFollowAJobUntilItHasEnded) {
  StartCoordinator();
  const std::string job = Submit(BoxScene(), {"--spp", "16"});
  const Outcome now = Ask({"logs", job});
  EXPECT_EQ(now.code, 0) << now.errors;
  EXPECT_THAT(now.output, HasSubstr("submitted"));
  Process follow(folder(), "tessera", {"logs", job, "--follow", "--json", "--coordinator", address()});
  EXPECT_TRUE(Eventually([&] { return follow.Output().find("submitted") != std::string::npos; }));
  EXPECT_EQ(Ask({"cancel", job}).code, 0);
  EXPECT_EQ(follow.Wait(), 0) << follow.Errors();
  std::istringstream lines(follow.Output());
  uint64_t last = 0;
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const auto entry = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(entry.is_object()) << line;
    EXPECT_GT(entry["number"], last);
    last = entry["number"];
    EXPECT_GT(entry["unix_time"], 1e9);
    text = entry["text"];
  }
  EXPECT_EQ(text, "cancelled");
  EXPECT_EQ(Ask({"logs", "99"}).code, 2);
}

// As watch, fetch and status do.
TEST_F(Logs, AreThoseOfTheOnlyOpenJobIfNoneIsNamed) {
  StartCoordinator();
  EXPECT_THAT(Ask({"logs"}).errors, HasSubstr("no job of this farm is yours"));
  const std::string first = Submit(BoxScene(), {"--spp", "16", "--name", "first"});
  const std::string second = Submit(BoxScene(), {"--spp", "16", "--name", "second"});
  for (const char* command : {"logs", "watch", "fetch", "status"}) {
    const Outcome refused = Ask({command});
    EXPECT_EQ(refused.code, 2) << command;
    EXPECT_THAT(refused.errors, HasSubstr("1 \"first\" (waiting), 2 \"second\" (waiting)")) << command;
  }
  EXPECT_EQ(Ask({"cancel", second}).code, 0);
  const Outcome log = Ask({"logs"});
  EXPECT_EQ(log.code, 0) << log.errors;
  EXPECT_THAT(log.errors, HasSubstr("job 1 \"first\"\n"));
  const Outcome status = Ask({"status", "--json"});
  EXPECT_EQ(status.code, 0) << status.errors;
  EXPECT_THAT(status.output, HasSubstr("\"name\":\"first\""));
  StartWorker("one");
  const Outcome watch = Ask({"watch"});
  EXPECT_EQ(watch.code, 0) << watch.errors;
  EXPECT_THAT(watch.output, HasSubstr("job 1 \"first\""));
  EXPECT_THAT(Ask({"fetch", "--preview"}).errors, HasSubstr("job 2 \"second\"")) << "the last one";
  EXPECT_EQ(Ask({"fetch", first}).code, 0);
  EXPECT_TRUE(Exists("job-1.exr"));
}

}  // namespace
}  // namespace tessera
