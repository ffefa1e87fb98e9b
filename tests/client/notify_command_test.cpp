#include "client/notify_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::string TextOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(NotifyCommand, FindsTheJobInItsEnvironment) {
  const TemporaryDir folder;
  JobStatus status;
  status.job = JobId{12};
  status.name = "film";
  status.state = JobState::kFailed;
  status.reason = "no light";
  RunNotifyCommand("echo \"$TESSERA_JOB_ID $TESSERA_JOB_NAME $TESSERA_JOB_STATE $TESSERA_JOB_REASON\" > '" +
                       (folder / "out") + "'",
                   NoticeOf(status));
  EXPECT_EQ(TextOf(folder / "out"), "12 film failed no light\n");
}

TEST(NotifyCommand, DoesNotRunWhatNamesContain) {
  const TemporaryDir folder;
  const std::string victim = folder / "victim";
  Notice notice;
  notice.name = "$(touch '" + victim + "'); touch '" + victim + "'";
  RunNotifyCommand("echo \"$TESSERA_JOB_NAME\" > '" + (folder / "out") + "'", notice);
  EXPECT_EQ(TextOf(folder / "out"), notice.name + "\n");
  EXPECT_FALSE(std::filesystem::exists(victim));
}

TEST(NotifyCommand, ThatFailsIsAWarning) {
  testing::internal::CaptureStderr();
  RunNotifyCommand("echo to stdout; exit 3", {});
  const std::string errors = testing::internal::GetCapturedStderr();
  EXPECT_THAT(errors, HasSubstr("to stdout\n")) << "answers of the program are not mixed with it";
  EXPECT_THAT(errors, HasSubstr("--notify-command ended with exit code 3"));
}

TEST(NotifyCommand, ReceivesSignalsThatThisProgramIgnores) {
  testing::internal::CaptureStderr();
  RunNotifyCommand("kill -PIPE $$", {});
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("ended by signal 13"));
}

}  // namespace
}  // namespace tessera
