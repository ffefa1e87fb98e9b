#include "renderer/util/shared_cache.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

std::shared_ptr<const int> Value(int value) {
  return std::make_shared<const int>(value);
}

TEST(SharedCache, GivesWhatItKeeps) {
  SharedCache cache(100);
  EXPECT_EQ(cache.Find<int>("a"), nullptr);
  cache.Keep("a", Value(7), 10);
  ASSERT_NE(cache.Find<int>("a"), nullptr);
  EXPECT_EQ(*cache.Find<int>("a"), 7);
  EXPECT_EQ(cache.bytes(), 10u);
}

TEST(SharedCache, TheFirstValueOfAKeyStays) {
  SharedCache cache(100);
  cache.Keep("a", Value(7), 10);
  cache.Keep("a", Value(8), 10);
  EXPECT_EQ(*cache.Find<int>("a"), 7);
  EXPECT_EQ(cache.bytes(), 10u);
}

TEST(SharedCache, WhatWasNotUsedForLongestGoesFirst) {
  SharedCache cache(30);
  for (const char* key : {"a", "b", "c"}) cache.Keep(key, Value(1), 10);
  EXPECT_NE(cache.Find<int>("a"), nullptr);
  cache.Keep("d", Value(1), 10);
  EXPECT_EQ(cache.Find<int>("b"), nullptr);
  EXPECT_NE(cache.Find<int>("a"), nullptr);
  EXPECT_NE(cache.Find<int>("c"), nullptr);
  EXPECT_NE(cache.Find<int>("d"), nullptr);
  EXPECT_EQ(cache.bytes(), 30u);
}

TEST(SharedCache, WhatIsLargerThanTheWholeIsNotKept) {
  SharedCache cache(30);
  cache.Keep("a", Value(1), 10);
  cache.Keep("b", Value(1), 31);
  EXPECT_NE(cache.Find<int>("a"), nullptr);
  EXPECT_EQ(cache.Find<int>("b"), nullptr);
}

TEST(SharedCache, AValueThatHasGoneLivesOnWithItsUsers) {
  SharedCache cache(10);
  cache.Keep("a", Value(7), 10);
  const auto user = cache.Find<int>("a");
  cache.Keep("b", Value(8), 10);
  EXPECT_EQ(cache.Find<int>("a"), nullptr);
  EXPECT_EQ(*user, 7);
}

}  // namespace
}  // namespace tessera
