#include "tests/bench/bench_table.h"

#include <gmock/gmock.h>

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

BenchRow Row(const std::string& scene, double cpu, double relmse, double spread = 0) {
  return {.scene = scene,
          .render_cpu_s = cpu,
          .relmse = relmse,
          .relmse_x_cpu_s = cpu * relmse,
          .cpu_spread = spread,
          .relmse_spread = spread};
}

TEST(BenchTable, CsvIsReadAsItWasWritten) {
  BenchRow row = Row("coffee", 1.25, 0.0078125, 0.5);
  row.shadow_rays_per_cpu_s = 2.5e6;
  row.peak_mb = 62;
  const Result<std::vector<BenchRow>> read = ReadBenchCsv(ToCsv({row, Row("box", 3, 0)}));
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[0].scene, "coffee");
  EXPECT_EQ((*read)[0].render_cpu_s, 1.25);
  EXPECT_EQ((*read)[0].relmse, 0.0078125);
  EXPECT_EQ((*read)[0].shadow_rays_per_cpu_s, 2.5e6);
  EXPECT_EQ((*read)[0].peak_mb, 62);
  EXPECT_EQ((*read)[1].render_cpu_s, 3);
}

TEST(BenchTable, DamagedCsvIsRefusedWithItsLine) {
  const std::string good = ToCsv({Row("coffee", 1, 1)});
  EXPECT_THAT(ReadBenchCsv("").error().message, HasSubstr("line 1"));
  EXPECT_THAT(ReadBenchCsv("scene,wall\n").error().message, HasSubstr("line 1"));
  EXPECT_THAT(ReadBenchCsv(good + "tea,1,2\n").error().message, HasSubstr("line 3: 3 fields"));
  std::string text = good;
  text.replace(text.rfind(",1,"), 3, ",x,");
  EXPECT_THAT(ReadBenchCsv(text).error().message, HasSubstr("line 2: \"x\""));
}

TEST(BenchTable, ColumnsMayBeMissingButNotUnknown) {
  const auto read = ReadBenchCsv("scene,relmse,render_cpu_s\ntea,0.5,3\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ((*read)[0].relmse, 0.5);
  EXPECT_EQ((*read)[0].render_cpu_s, 3);
  EXPECT_EQ((*read)[0].peak_mb, 0);
  EXPECT_THAT(ReadBenchCsv("scene,wall\n").error().message, HasSubstr("\"wall\""));
}

TEST(BenchTable, ComparisonDividesBeforeByAfterAndAveragesGeometrically) {
  const std::string table = CompareBenches({Row("a", 4, 0.2), Row("b", 1, 0.1), Row("only before", 1, 1)},
                                           {Row("b", 1, 0.1), Row("a", 2, 0.1)});
  EXPECT_THAT(table, HasSubstr("| scene | load | CPU | instructions | relMSE | relMSE x CPU | memory |"));
  EXPECT_THAT(table, HasSubstr("| a | - | 2.000 | - | 2.000 | 4.000 | - |"));
  EXPECT_THAT(table, HasSubstr("| b | - | 1.000 | - | 1.000 | 1.000 | - |"));
  EXPECT_THAT(table, HasSubstr("| geometric mean | - | 1.414 | - | 1.414 | 2.000 | - |"));
  EXPECT_THAT(table, Not(HasSubstr("only before")));
}

TEST(BenchTable, ComparisonMarksWhatNoiseExplains) {
  const std::string table =
      CompareBenches({Row("a", 1.1, 2, 0.1), Row("b", 1, 0)}, {Row("a", 1, 1, 0.1), Row("b", 1, 0)});
  EXPECT_THAT(table, HasSubstr("| a | - | 1.100~ | - | 2.000 | 2.200 | - |"));
  EXPECT_THAT(table, HasSubstr("| b | - | 1.000 | - | - | - | - |"));
}

TEST(BenchTable, LoadInstructionsAndMemoryAreCompared) {
  BenchRow before = Row("a", 1, 1), after = before;
  before.load_cpu_s = 3;
  after.load_cpu_s = 1.5;
  before.instructions_per_path = 9000;
  after.instructions_per_path = 10'000;
  before.peak_mb = 100;
  after.peak_mb = 50;
  EXPECT_THAT(CompareBenches({before}, {after}),
              HasSubstr("| a | 2.000 | 1.000 | 0.900 | 1.000 | 1.000 | 2.000 |"));
}

}  // namespace
}  // namespace tessera
