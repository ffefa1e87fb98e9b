#include "proto/shell/backoff.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Backoff, DoublesUpToItsMaximumAndRestartsAfterASuccess) {
  Backoff backoff(1);
  auto full = kBackoffFirst;
  for (int i = 0; i < 40; ++i) {
    const auto wait = backoff.Next();
    EXPECT_GE(wait, full / 2);
    EXPECT_LE(wait, full);
    full = std::min(full * 2, kBackoffMax);
  }
  backoff.Reset();
  EXPECT_LE(backoff.Next(), kBackoffFirst);
}

TEST(Backoff, EverySeedGivesItsOwnSequenceOfWaits) {
  Backoff one(1), same(1), other(2);
  bool differs = false;
  for (int i = 0; i < 10; ++i) {
    const auto wait = one.Next();
    EXPECT_EQ(wait, same.Next());
    differs = differs || wait != other.Next();
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace tessera
