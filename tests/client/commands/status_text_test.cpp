#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/commands/status_text.h"
#include "client/commands/text_table.h"
#include "client/commands/times_text.h"
#include "client/progress_line.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(Progress, IsShownInReadableUnits) {
  Progress progress{12'300'000, 28'600'000, 1'420'000, 2, 8.7, 11.5, "", {}};
  EXPECT_EQ(
      ProgressText(progress, "worker"),
      " 43.0 %  12.3 Msamples of 28.6 Msamples  1.42 Msamples/s  2 workers  8.7 s elapsed  11.5 s left");
  progress = {100, 100, 950, 1, 192, 0, "", {}};
  EXPECT_EQ(ProgressText(progress, "thread"),
            "100.0 %  100 samples of 100 samples  950 samples/s  1 thread  3 min 12 s elapsed");
  progress = {0, 100, 0, 0, 0, -1, "disk full", {}};
  EXPECT_THAT(ProgressText(progress, "worker"), HasSubstr("time left unknown  (disk full)"));
  progress.has_ended = true;
  EXPECT_THAT(ProgressText(progress, "worker"), testing::Not(HasSubstr("left")));
}

TEST(Progress, CountsTheFramesOfASequence) {
  Progress progress{50, 100, 950, 1, 2, 2, "", {}};
  EXPECT_EQ(ProgressText(progress, "worker").find("frames"), std::string::npos);
  progress.frames = {3, 24};
  EXPECT_THAT(ProgressText(progress, "worker"), HasSubstr("2.0 s elapsed  3 of 24 frames  2.0 s left"));
}

TEST(Times, ListLargePartsFirstAndOmitSmallOnesFromTheLine) {
  JobTimes times;
  times.load_s = 20;
  times.render_s = 79.6;
  times.tail_s = 0.4;
  EXPECT_EQ(TimesLine(times), "80 % rendering, 20 % building the scene");
  EXPECT_THAT(TimesTable(times), HasSubstr("1 min 40 s of render slots"));
  EXPECT_THAT(TimesTable(times), HasSubstr("   0.4 %         0.4 s  waiting for the last units\n"));
  EXPECT_EQ(TimesLine({}), "") << "a farm without slots has no shares";
}

TEST(Progress, DurationsGrowIntoMinutesAndHours) {
  EXPECT_EQ(DurationText(0.04), "0.0 s");
  EXPECT_EQ(DurationText(59.94), "59.9 s");
  EXPECT_EQ(DurationText(59.97), "60.0 s");
  EXPECT_EQ(DurationText(61), "1 min 1 s");
  EXPECT_EQ(DurationText(7500), "2 h 5 min");
  EXPECT_EQ(DurationText(-1), "0.0 s");
}

TEST(StatusText, JsonIsValidForNamesThatAreNotUtf8) {
  JobStatus status;
  status.job = JobId{7};
  status.name = "caf\xe9 \"quoted\"";
  status.state = JobState::kRunning;
  const std::string json = JobJson(status);
  EXPECT_THAT(json, HasSubstr("\"job\":7"));
  EXPECT_THAT(json, HasSubstr("\\\"quoted\\\""));
  EXPECT_THAT(json, HasSubstr("\"left_s\":null"));
}

TEST(StatusText, TablesShortenLongNamesAndJsonDoesNot) {
  JobStatus job;
  job.name = std::string(200, 'n');
  job.owner.name = std::string(200, 'o');
  WorkerStatus worker;
  worker.name = std::string(200, 'w');
  for (const std::string& table : {JobTable({job}), WorkerTable({worker})})
    EXPECT_LT(table.find('\n'), 200u) << "the headings are as long as the longest line";
  EXPECT_THAT(JobTable({job}), HasSubstr(std::string(kNameWidthMax - 1, 'n') + "\u2026  "));
  EXPECT_THAT(JobsJson({job}), testing::AllOf(HasSubstr(job.name), HasSubstr(job.owner.name)));
  EXPECT_THAT(WorkersJson({worker}), HasSubstr(worker.name));
}

TEST(StatusText, ShowsThePriorityUnlessItIsZero) {
  JobStatus status;
  status.name = "shot";
  EXPECT_EQ(JobText(status).find("priority"), std::string::npos);
  status.priority = -7;
  EXPECT_THAT(JobText(status), HasSubstr("\"shot\", priority -7: "));
  EXPECT_THAT(JobTable({status}), HasSubstr("  -7  "));
}

TEST(StatusText, ShowsTheOwnerIfItIsKnown) {
  JobStatus status;
  status.name = "shot";
  EXPECT_THAT(JobText(status), testing::Not(HasSubstr("owner")));
  EXPECT_THAT(JobJson(status), HasSubstr("\"owner\":\"\",\"owner_member\":null"));
  status.owner = {MemberId{0x1f}, "ada"};
  EXPECT_THAT(JobText(status), HasSubstr("\"shot\", owner ada: "));
  EXPECT_THAT(JobTable({status}), HasSubstr("  ada  "));
  EXPECT_THAT(JobJson(status), HasSubstr("\"owner\":\"ada\",\"owner_member\":\"000000000000001f\""));
}

TEST(StatusText, DistinguishesADrainedWorkerFromADrainingOne) {
  WorkerStatus worker;
  worker.draining = true;
  worker.leases = 2;
  EXPECT_THAT(WorkerTable({worker}), HasSubstr("  draining\n"));
  worker.leases = 0;
  EXPECT_THAT(WorkerTable({worker}), HasSubstr("  drained\n"));
}

TEST(StatusText, ShowsWhyAWorkerIsQuarantined) {
  WorkerStatus worker;
  worker.name = "slow";
  worker.quarantined = true;
  worker.reason = "results differ";
  EXPECT_THAT(WorkerTable({worker}), HasSubstr("quarantined: results differ"));
}

TEST(ProgressText, LeavesOutWhatMattersLeastInANarrowTerminal) {
  Progress progress;
  progress.samples_done = 5'000'000;
  progress.samples_total = 10'000'000;
  progress.samples_per_second = 1'000'000;
  progress.workers = 4;
  progress.elapsed_s = 5;
  progress.left_s = 5;
  progress.frames = {3, 24};
  const auto fitting = [&](size_t columns) { return ProgressText(progress, "worker", columns); };
  EXPECT_EQ(
      fitting(200),
      " 50.0 %  5.00 Msamples of 10.0 Msamples  1.00 Msamples/s  4 workers  5.0 s elapsed  3 of 24 frames  "
      "5.0 s left");
  EXPECT_EQ(fitting(79), " 50.0 %  1.00 Msamples/s  4 workers  5.0 s elapsed  3 of 24 frames  5.0 s left");
  EXPECT_EQ(fitting(70), " 50.0 %  1.00 Msamples/s  4 workers  3 of 24 frames  5.0 s left");
  EXPECT_EQ(fitting(50), " 50.0 %  4 workers  3 of 24 frames  5.0 s left");
  EXPECT_EQ(fitting(1), " 50.0 %  3 of 24 frames  5.0 s left");
}

}  // namespace
}  // namespace tessera
