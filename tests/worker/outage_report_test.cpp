#include "worker/outage_report.h"

#include <gmock/gmock.h>
#include <grpcpp/support/status.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>
#include <thread>

namespace tessera {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

const grpc::Status kUnavailable(grpc::StatusCode::UNAVAILABLE, "failed to connect");

// What is logged while it lives.
class LogCapture {
 public:
  LogCapture() : before_(spdlog::default_logger()) {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
  }
  ~LogCapture() { spdlog::set_default_logger(before_); }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;
  std::string text() const { return text_.str(); }
  int lines() const {
    const std::string all = text();
    return static_cast<int>(std::ranges::count(all, '\n'));
  }

 private:
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
};

// The times of the reports in an outage of `duration` with a failure each second.
std::vector<std::chrono::seconds> ReportTimes(std::chrono::seconds duration) {
  const LogCapture log;
  OutageReport report(*ParseAddress("unix:/no-such-folder/socket", "test"));
  std::vector<std::chrono::seconds> times;
  for (auto at = 0s; at <= duration; ++at) {
    const int before = log.lines();
    report.Failed(kUnavailable, OutageReport::TimePoint(at));
    if (log.lines() > before) times.push_back(at);
    // Checks take real time.
    std::this_thread::sleep_for(2ms);
  }
  EXPECT_THAT(log.text(), HasSubstr("address=unix:/no-such-folder/socket"));
  EXPECT_THAT(log.text(), HasSubstr("the socket does not exist"));
  return times;
}

TEST(OutageReport, ComesWithinSecondsAndThenLessAndLessOften) {
  const auto times = ReportTimes(400s);
  ASSERT_GE(times.size(), 3u);
  EXPECT_LE(times.size(), 6u);
  EXPECT_LE(times[0], 5s);
  for (size_t i = 2; i < times.size(); ++i) EXPECT_GT(times[i] - times[i - 1], times[i - 1] - times[i - 2]);
}

TEST(OutageReport, AFullFarmIsNamedImmediatelyAndNotCalledUnreachable) {
  const LogCapture log;
  OutageReport report(*ParseAddress("unix:/no-such-folder/socket", "test"));
  const grpc::Status full(grpc::StatusCode::RESOURCE_EXHAUSTED, "the farm is full");
  for (auto at = 0s; at <= 400s; ++at) report.Postponed(full, OutageReport::TimePoint(at));
  EXPECT_THAT(log.text(),
              HasSubstr("join_postponed address=unix:/no-such-folder/socket reason=\"the farm is full\""));
  EXPECT_THAT(log.text(), testing::Not(HasSubstr("unreachable")));
  EXPECT_GE(log.lines(), 4);
  EXPECT_LE(log.lines(), 7) << "less and less often";
}

TEST(OutageReport, StartsAgainWithTheNextOutage) {
  const LogCapture log;
  OutageReport report(*ParseAddress("unix:/no-such-folder/socket", "test"));
  report.Failed(kUnavailable, OutageReport::TimePoint(0s));
  report.Ended();
  report.Failed(kUnavailable, OutageReport::TimePoint(1000s));
  report.Failed(kUnavailable, OutageReport::TimePoint(1000s + 900ms));
  std::this_thread::sleep_for(20ms);
  report.Failed(kUnavailable, OutageReport::TimePoint(1000s + 950ms));
  EXPECT_EQ(log.text(), "");
}

}  // namespace
}  // namespace tessera
