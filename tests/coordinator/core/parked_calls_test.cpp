#include "coordinator/core/parked_calls.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using std::chrono::seconds;
constexpr WorkerId kAnn{1}, kBob{2};

TEST(ParkedCalls, ANewerCallOfAWorkerTakesThePlaceOfTheOlder) {
  ParkedCalls calls;
  EXPECT_EQ(calls.Park(kAnn, CallId{1}, seconds(5)), std::nullopt);
  EXPECT_EQ(calls.Park(kAnn, CallId{2}, seconds(9)), CallId{1});
  EXPECT_EQ(calls.WorkerOf(CallId{1}), std::nullopt);
  EXPECT_EQ(calls.WorkerOf(CallId{2}), kAnn);
  EXPECT_EQ(calls.next_due(), seconds(9));
}

TEST(ParkedCalls, TheFirstDueIsTheOneThatWaitsLongest) {
  ParkedCalls calls;
  calls.Park(kAnn, CallId{1}, seconds(5));
  calls.Park(kBob, CallId{2}, seconds(3));
  EXPECT_EQ(calls.FirstDue(seconds(2)), std::nullopt);
  EXPECT_EQ(calls.FirstDue(seconds(3)), kBob);
  EXPECT_EQ(calls.Take(kBob), CallId{2});
  EXPECT_EQ(calls.Take(kBob), std::nullopt);
  EXPECT_EQ(calls.FirstDue(seconds(4)), std::nullopt);
  EXPECT_TRUE(calls.Has(kAnn));
}

}  // namespace
}  // namespace tessera
