#include "client/commands/text_table.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(TextTable, HasColumnsAsWideAsTheirLongestCell) {
  TextTable table({{"JOB", Align::kRight}, {"NAME", Align::kLeft}, {"DONE", Align::kRight}});
  EXPECT_EQ(table.Text(), "JOB  NAME  DONE\n");
  table.Add({"7", "caf\xc3\xa9", "0 %"}, "");
  table.Add({"1234", "shot-12", "100 %"}, "paused: the disk is full");
  EXPECT_EQ(table.Text(),
            " JOB  NAME      DONE\n"
            "   7  caf\xc3\xa9       0 %\n"
            "1234  shot-12  100 %  paused: the disk is full\n");
}

TEST(TextTable, LongNamesEndInAnEllipsisAfterAWholeCharacter) {
  EXPECT_EQ(Shortened("", 4), "");
  EXPECT_EQ(Shortened("abcd", 4), "abcd");
  EXPECT_EQ(Shortened("abcde", 4), "abc\u2026");
  EXPECT_EQ(Shortened("caf\u00e9s", 4), "caf\u2026");
  EXPECT_EQ(Shortened("\u00e9\u00e9\U0001f600\u00e9\u00e9", 4), "\u00e9\u00e9\U0001f600\u2026");
  EXPECT_EQ(Shortened("\u00e9\u00e9\U0001f600\u00e9", 4), "\u00e9\u00e9\U0001f600\u00e9")
      << "four characters";
}

TEST(TextTable, EndsNoLineWithSpaces) {
  TextTable table({{"NAME", Align::kLeft}, {"VERSION", Align::kLeft}});
  table.Add({"blade", ""}, "");
  EXPECT_EQ(table.Text(), "NAME   VERSION\nblade\n");
}

}  // namespace
}  // namespace tessera
