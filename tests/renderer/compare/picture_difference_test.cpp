#include "renderer/compare/picture_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tessera {
namespace {

LoadedPicture Loaded(std::vector<float> values) {
  LoadedPicture picture;
  picture.width = static_cast<int>(values.size());
  picture.height = 1;
  picture.bounds = {0, 0, picture.width, 1};
  picture.channels = {"Y"};
  picture.values = std::move(values);
  return picture;
}

TEST(Compare, GivesTheFiguresOfItsDefinition) {
  const auto difference = Compare(Loaded({1.5f, 0.0f, -2.0f, 4.0f}), Loaded({1.0f, 0.0f, -2.0f, 7.0f}));
  ASSERT_TRUE(difference);
  EXPECT_DOUBLE_EQ(difference->mse, (0.25 + 9.0) / 4);
  EXPECT_DOUBLE_EQ(difference->relmse, (0.25 / 1.01 + 9.0 / 49.01) / 4);
  EXPECT_DOUBLE_EQ(difference->psnr_db, 10 * std::log10(4 / 9.25));
  EXPECT_DOUBLE_EQ(difference->maxabs, 3);
  EXPECT_FALSE(difference->identical);
}

TEST(Compare, IdenticalMeansTheSameBits) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(Compare(Loaded({1, nan}), Loaded({1, nan}))->identical);
  EXPECT_FALSE(Compare(Loaded({0.0f}), Loaded({-0.0f}))->identical);
  EXPECT_EQ(Compare(Loaded({0.0f}), Loaded({-0.0f}))->maxabs, 0);
  EXPECT_TRUE(std::isinf(Compare(Loaded({1, nan}), Loaded({1, 2}))->maxabs));
}

TEST(Compare, RefusesPicturesOfDifferentSizeOrChannels) {
  EXPECT_FALSE(Compare(Loaded({1, 2}), Loaded({1})));
  LoadedPicture other = Loaded({1});
  other.channels = {"Z"};
  EXPECT_FALSE(Compare(Loaded({1}), other));
}

TEST(Compare, LooksAtTheChannelsBothHave) {
  LoadedPicture two = Loaded({1});
  two.channels = {"A", "Y"};
  two.values = {9, 1};
  const auto difference = Compare(two, Loaded({1}));
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->mse, 0);
  EXPECT_FALSE(difference->identical);  // one of them holds more
}

}  // namespace
}  // namespace tessera
