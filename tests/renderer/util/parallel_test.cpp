#include "renderer/util/parallel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace tessera {
namespace {

TEST(ForEachItem, CallsTheBodyOnceForEachItem) {
  for (const int threads : {-1, 1, 2, 7}) {
    for (const size_t count : {size_t{0}, size_t{1}, size_t{5}, size_t{1000}}) {
      std::vector<std::atomic<int>> calls(count);
      ASSERT_TRUE(ForEachItem(count, threads, {}, [&](size_t i) { ++calls[i]; }));
      for (const auto& call : calls) EXPECT_EQ(call, 1);
    }
  }
}

TEST(ForEachItem, ReportsAnExceptionAndStartsNoMoreItems) {
  std::atomic<int> calls = 0;
  const auto done = ForEachItem(1000000, 3, {}, [&](size_t) {
    ++calls;
    throw std::runtime_error("no memory");
  });
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, testing::HasSubstr("no memory"));
  EXPECT_LE(calls, 3);
}

TEST(ForEachItem, IsInterruptedByAStop) {
  std::stop_source stop;
  std::atomic<int> calls = 0;
  const auto done = ForEachItem(1000000, 2, stop.get_token(), [&](size_t) {
    ++calls;
    stop.request_stop();
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::kInterrupted);
  EXPECT_LE(calls, 2);
}

TEST(ForEachItem, IsCompleteIfTheStopComesWithTheLastItem) {
  std::stop_source stop;
  EXPECT_TRUE(ForEachItem(1, 2, stop.get_token(), [&](size_t) { stop.request_stop(); }));
}

}  // namespace
}  // namespace tessera
