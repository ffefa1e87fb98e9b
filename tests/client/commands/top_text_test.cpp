#include "client/commands/top_text.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;

JobStatus JobOf(uint64_t id, JobState state, const std::string& name) {
  JobStatus job;
  job.job = JobId{id};
  job.state = state;
  job.name = name;
  job.samples_done = 25;
  job.samples_total = 100;
  return job;
}

FarmView ViewOf(int jobs, int workers) {
  FarmView view{"farm:7700", {}, {}};
  for (int i = 1; i <= jobs; ++i)
    view.jobs.push_back(JobOf(static_cast<uint64_t>(i), JobState::kRunning, fmt::format("film-{}", i)));
  for (int i = 1; i <= workers; ++i) {
    WorkerStatus worker;
    worker.name = fmt::format("blade-{}", i);
    worker.slots = 8;
    worker.samples_per_second = 1000;
    view.workers.push_back(worker);
  }
  return view;
}

size_t Find(const std::vector<std::string>& lines, const std::string& text) {
  const auto found = std::ranges::find_if(
      lines, [&](const std::string& line) { return line.find(text) != std::string::npos; });
  return static_cast<size_t>(found - lines.begin());
}

TEST(TopScreen, ShowsTotalsAndEveryoneIfThereIsRoom) {
  const auto lines = TopScreen(ViewOf(2, 3), {120, 40});
  EXPECT_THAT(lines.front(),
              HasSubstr("farm:7700   2 running, 0 waiting   3 workers with 24 threads   3000 samples/s"));
  EXPECT_LT(Find(lines, "film-2"), Find(lines, "film-1")) << "the newest first";
  EXPECT_THAT(lines[Find(lines, "film-1")], HasSubstr("[#####...............]  25.0 %"));
  EXPECT_LT(Find(lines, "blade-3"), lines.size());
}

TEST(TopScreen, FitsAnyTerminal) {
  for (const int rows : {1, 5, 8, 24, 60}) {
    for (const int columns : {1, 20, 80, 200}) {
      for (const auto& [jobs, workers] :
           {std::pair(0, 0), std::pair(100, 0), std::pair(0, 100), std::pair(100, 100)}) {
        const auto lines = TopScreen(ViewOf(jobs, workers), {columns, rows});
        EXPECT_LE(lines.size(), static_cast<size_t>(rows)) << rows;
        for (const std::string& line : lines) EXPECT_LE(line.size(), static_cast<size_t>(columns)) << line;
      }
    }
  }
  const auto lines = TopScreen(ViewOf(100, 2), {120, 24});
  EXPECT_LT(Find(lines, "blade-2"), lines.size()) << "a long list leaves a short one its place";
  EXPECT_THAT(lines[Find(lines, "... and ")], HasSubstr("more"));
}

TEST(TopScreen, PutsWhatNeedsAttentionFirst) {
  FarmView view = ViewOf(1, 2);
  view.jobs.push_back(JobOf(7, JobState::kFailed, "old"));
  view.jobs.back().reason = "no light";
  view.workers[1].quarantined = true;
  view.workers[1].reason = "wrong bits";
  const auto lines = TopScreen(view, {160, 24});
  EXPECT_LT(Find(lines, "film-1"), Find(lines, "old"));
  EXPECT_THAT(lines[Find(lines, "old")], HasSubstr("(no light)"));
  EXPECT_LT(Find(lines, "blade-2"), Find(lines, "blade-1"));
  EXPECT_THAT(lines[Find(lines, "blade-2")], HasSubstr("quarantined"));
}

TEST(TopScreen, ShowsNamesAndReasonsOnNarrowTerminals) {
  FarmView view = ViewOf(1, 2);
  view.jobs.front().left = std::chrono::seconds(125);
  view.jobs.push_back(JobOf(2, JobState::kPaused, "hall"));
  view.jobs.back().reason = "disk full";
  view.workers[1].quarantined = true;
  view.workers[1].reason = "wrong bits";
  const auto wide = TopScreen(view, {80, 24});
  EXPECT_THAT(wide,
              Contains("    1  running    [##........]  25.0 %    2 min 5 s  film-1            0 workers"));
  EXPECT_THAT(wide,
              Contains("idle         [..........]   0 %  blade-1                       1000 samples/s"));
  EXPECT_THAT(wide, Contains(HasSubstr("?  hall  (disk full)")));
  const auto narrow = TopScreen(view, {40, 24});
  EXPECT_THAT(narrow, Contains("farm:7700   1 running, 1 waiting"));
  EXPECT_THAT(narrow, Contains("2 workers with 16 threads"));
  EXPECT_THAT(narrow, Contains("  1 running    25 % film-1  2 min 5 s"));
  EXPECT_THAT(narrow, Contains("  2 paused     25 % hall  ?  (disk full)"));
  EXPECT_THAT(narrow, Contains("quarantined   0 % blade-2  (wrong bits)"));
}

TEST(TopLines, LeavesNothingOut) {
  EXPECT_EQ(TopLines(ViewOf(100, 50)).size(), 2u + 1 + 100 + 1 + 1 + 50);
}

}  // namespace
}  // namespace tessera
