#include "client/progress_board.h"

#include <gtest/gtest.h>

#include "client/terminal.h"

namespace tessera {
namespace {

TEST(FirstColumns, CutsBetweenCharacters) {
  EXPECT_EQ(FirstColumns("abc", 2), "ab");
  EXPECT_EQ(FirstColumns("abc", 3), "abc");
  EXPECT_EQ(FirstColumns("abc", 9), "abc");
  EXPECT_EQ(FirstColumns("\xc3\xa9t\xc3\xa9", 2), "\xc3\xa9t");
  EXPECT_EQ(FirstColumns("\xc3\xa9t\xc3\xa9", 3), "\xc3\xa9t\xc3\xa9");
  EXPECT_EQ(FirstColumns("abc", 0), "");
}

TEST(ProgressBoard, IsPlainLinesWithoutATerminal) {
  testing::internal::CaptureStderr();
  {
    ProgressBoard board;
    board.Show(JobId{1}, "job 1: 10 %", false);
    board.Show(JobId{2}, "job 2: 20 %", false);
    board.Show(JobId{2}, "job 2: 30 %", false);
    board.Show(JobId{1}, "job 1: finished", true);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "job 1: 10 %\njob 1: finished\njob 2: 30 %\n");
}

}  // namespace
}  // namespace tessera
