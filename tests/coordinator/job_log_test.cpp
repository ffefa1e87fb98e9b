// The log of a job: bounded, in order, and there after a restart.
#include "coordinator/job_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::HasSubstr;

JobStatus KnownJob(uint64_t job, uint64_t submission, JobState state = JobState::kRunning) {
  JobStatus status;
  status.job = JobId{job};
  status.submission = submission;
  status.state = state;
  return status;
}

FarmOutput Messages(uint64_t job, uint64_t submission, const std::vector<std::string>& texts,
                    std::optional<JobMessage::Change> change = std::nullopt) {
  FarmOutput output;
  for (const std::string& text : texts)
    output.messages.push_back({JobId{job}, MessageLevel::kWarning, text, change, submission});
  return output;
}

std::vector<std::string> TextsOf(const JobLog& log, uint64_t job) {
  std::vector<std::string> texts;
  const auto page = log.Read(JobId{job}, 0);
  for (const JobLogEntry& entry : page->entries) texts.push_back(entry.text);
  return texts;
}

class JobLogs : public testing::Test {
 protected:
  // The tasks of another thread, run when the test wants it.
  JobLog::RunLater Later() {
    return [this](auto task) { tasks.push_back(std::move(task)); };
  }
  void RunTasks() {
    for (const auto& task : std::exchange(tasks, {})) task();
  }
  TemporaryDir folder;
  const std::string path = folder / "messages";
  std::vector<std::function<void()>> tasks;
};

TEST_F(JobLogs, EntriesAreReadInPagesByTheirNumbers) {
  JobLog log(path, Later());
  EXPECT_EQ(log.Restore({}), "");
  EXPECT_FALSE(log.Read(JobId{1}, 0)) << "a job that is not known";
  log.Note(Messages(1, 7, {"a", "b"}));
  log.Note(Messages(2, 8, {"other"}));
  log.Note(Messages(1, 7, {"c"}));
  const auto page = log.Read(JobId{1}, 0, 2);
  ASSERT_EQ(page->entries.size(), 2u);
  EXPECT_TRUE(page->has_more);
  EXPECT_LT(page->entries[0].number, page->entries[1].number);
  EXPECT_GT(page->entries[0].unix_time_ms, 0);
  const auto rest = log.Read(JobId{1}, page->entries[1].number, 2);
  ASSERT_EQ(rest->entries.size(), 1u);
  EXPECT_EQ(rest->entries[0].text, "c");
  EXPECT_FALSE(rest->has_more);
  EXPECT_TRUE(log.Read(JobId{1}, UINT64_MAX, 2)->entries.empty());
}

TEST_F(JobLogs, AJobHasEndedWhenItsLastEntryIsRead) {
  JobLog log(path, Later());
  log.Restore({});
  log.Note(Messages(1, 7, {"a"}));
  EXPECT_FALSE(log.Read(JobId{1}, 0)->has_ended);
  log.Note(Messages(1, 7, {"finished"}, JobMessage::Change::kEnds));
  EXPECT_FALSE(log.Read(JobId{1}, 0, 1)->has_ended) << "an entry follows";
  EXPECT_TRUE(log.Read(JobId{1}, 0)->has_ended);
  log.Note(Messages(1, 7, {"extended"}, JobMessage::Change::kOpens));
  EXPECT_FALSE(log.Read(JobId{1}, 0)->has_ended);
}

TEST_F(JobLogs, AFloodKeepsTheNewestOfAJobAndABoundedSizeOfAll) {
  JobLog log(path, Later());
  log.Restore({});
  log.Note(Messages(1, 7, {"first"}));
  const std::string text(1000, 'x');
  for (int i = 0; i < 3000; ++i) log.Note(Messages(2, 8, {text + std::to_string(i)}));
  EXPECT_EQ(TextsOf(log, 2).size(), kLogEntriesPerJobMax);
  EXPECT_EQ(TextsOf(log, 2).back(), text + "2999");
  EXPECT_EQ(TextsOf(log, 1).size(), 1u) << "another job's flood removes nothing";
  for (uint64_t job = 3; job < 60; ++job) {
    for (size_t i = 0; i < kLogEntriesPerJobMax; ++i) log.Note(Messages(job, job, {text}));
  }
  size_t bytes = 0;
  for (uint64_t job = 1; job < 60; ++job) {
    for (const std::string& each : TextsOf(log, job)) bytes += each.size();
  }
  EXPECT_LE(bytes, kLogBytesMax);
  EXPECT_GT(bytes, kLogBytesMax / 2);
  EXPECT_TRUE(TextsOf(log, 1).empty()) << "the oldest of all give way";
  EXPECT_EQ(TextsOf(log, 59).size(), kLogEntriesPerJobMax);
  EXPECT_EQ(tasks.size(), 1u) << "one task writes what has come until it runs";
}

TEST_F(JobLogs, EntriesAreThereAfterARestartAndNumbersGrow) {
  uint64_t last = 0;
  {
    JobLog log(path, Later());
    log.Restore({});
    log.Note(Messages(1, 7, {"a", "b"}));
    log.Note(Messages(2, 8, {"finished"}, JobMessage::Change::kEnds));
    RunTasks();
    last = log.Read(JobId{2}, 0)->entries.back().number;
  }
  JobLog log(path, Later());
  EXPECT_EQ(log.Restore({KnownJob(1, 7), KnownJob(2, 8, JobState::kFinished), KnownJob(3, 9)}), "");
  EXPECT_THAT(TextsOf(log, 1), testing::ElementsAre("a", "b"));
  EXPECT_TRUE(log.Read(JobId{2}, 0)->has_ended);
  EXPECT_TRUE(TextsOf(log, 3).empty());
  log.Note(Messages(1, 7, {"c"}));
  EXPECT_GT(log.Read(JobId{1}, 0)->entries.back().number, last);
}

TEST_F(JobLogs, EntriesOfAnotherJobOfTheSameNumberAreNotShown) {
  {
    JobLog log(path, Later());
    log.Restore({});
    log.Note(Messages(1, 7, {"a"}));
    log.Flush();
  }
  JobLog log(path, Later());
  log.Restore({KnownJob(1, 1234)});
  EXPECT_TRUE(TextsOf(log, 1).empty());
}

TEST_F(JobLogs, ForgottenJobsHaveNoLog) {
  JobLog log(path, Later());
  log.Restore({});
  log.Note(Messages(1, 7, {"a"}));
  FarmOutput forgotten = Messages(1, 0, {"of a job that is gone"});
  forgotten.forgotten = {JobId{1}, JobId{5}};
  log.Note(forgotten);
  EXPECT_FALSE(log.Read(JobId{1}, 0));
}

TEST_F(JobLogs, ADamagedFileIsBegunAnewAndTheReasonIsReported) {
  std::ofstream(path) << "something else that is no log of messages";
  {
    JobLog log(path, Later());
    EXPECT_THAT(log.Restore({KnownJob(1, 7)}), HasSubstr("messages"));
    log.Note(Messages(1, 7, {"a"}));
    log.Flush();
  }
  JobLog log(path, Later());
  EXPECT_EQ(log.Restore({KnownJob(1, 7)}), "");
  EXPECT_THAT(TextsOf(log, 1), testing::ElementsAre("a"));
}

TEST_F(JobLogs, AFullDiskKeepsEntriesInMemoryAndLaterOnesAreWritten) {
  {
    JobLog log(path, Later());
    log.Restore({});
    {
      const NoFileGrows full;
      for (int i = 0; i < 100; ++i) {
        log.Note(Messages(1, 7, {"while it is full"}));
        RunTasks();
      }
      EXPECT_EQ(TextsOf(log, 1).size(), 100u);
    }
    log.Note(Messages(1, 7, {"there is space"}));
    RunTasks();
  }
  JobLog log(path, Later());
  log.Restore({KnownJob(1, 7)});
  EXPECT_THAT(TextsOf(log, 1), testing::Contains("there is space"));
}

TEST_F(JobLogs, TheFileStaysBounded) {
  JobLog log(path, Later());
  log.Restore({});
  const std::string text(4000, 'x');
  for (int i = 0; i < 60; ++i) {
    for (int k = 0; k < 100; ++k) log.Note(Messages(1, 7, {text}));
    RunTasks();
  }
  EXPECT_LT(std::filesystem::file_size(path), size_t{12} << 20) << "24 MB were written";
}

TEST_F(JobLogs, TextIsOneLineOfUtf8) {
  JobLog log(path, Later());
  log.Restore({});
  log.Note(Messages(1, 7, {"a\nb\xff\x1b[31m", std::string(100'000, 'x')}));
  EXPECT_EQ(TextsOf(log, 1)[0], "a b\xef\xbf\xbd [31m");
  EXPECT_LE(TextsOf(log, 1)[1].size(), kReasonBytesMax);
}

TEST(StoredMessages, AreReadAsTheyWereWrittenAndNothingElseIs) {
  const StoredMessage message{JobId{3}, 9, {17, 1'700'000'000'123, MessageLevel::kError, "a text"}};
  const std::string bytes = EncodeMessage(message);
  const auto read = DecodeMessage(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->job, message.job);
  EXPECT_EQ(read->submission, message.submission);
  EXPECT_EQ(read->entry, message.entry);
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(DecodeMessage(bytes.substr(0, size))) << size;
  EXPECT_FALSE(DecodeMessage(bytes + "x"));
  StoredMessage unknown = message;
  unknown.entry.level = static_cast<MessageLevel>(3);
  EXPECT_FALSE(DecodeMessage(EncodeMessage(unknown)));
}

}  // namespace
}  // namespace tessera
