#include "renderer/compare/difference_picture.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace tessera {
namespace {

LoadedPicture Row(const std::vector<std::string>& channels, const std::vector<float>& values) {
  LoadedPicture picture;
  picture.channels = channels;
  picture.values = values;
  picture.width = static_cast<int>(values.size() / channels.size());
  picture.height = 1;
  picture.bounds = {0, 0, picture.width, 1};
  return picture;
}

int Brightness(const BytePicture& picture, int x, int y) {
  const size_t i = static_cast<size_t>((y * picture.width + x) * 3);
  return picture.values[i] + picture.values[i + 1] + picture.values[i + 2];
}

TEST(DifferencePicture, GrowsBrighterWithTheErrorUpToTheTop) {
  std::vector<float> errors;
  for (int i = 0; i <= 100; ++i) errors.push_back(static_cast<float>(i) * 0.05f);
  const BytePicture picture = DrawErrors({101, errors, 5, "FLIP"});
  for (int x = 1; x <= 100; ++x) EXPECT_GE(Brightness(picture, x, 0), Brightness(picture, x - 1, 0)) << x;
  EXPECT_LT(Brightness(picture, 0, 0), 10);
  EXPECT_GT(Brightness(picture, 100, 0), 650);
  const std::vector<float> beyond = {5, 7, std::numeric_limits<float>::infinity()};
  const BytePicture clamped = DrawErrors({3, beyond, 5, ""});
  EXPECT_EQ(Brightness(clamped, 1, 0), Brightness(clamped, 0, 0));
  EXPECT_EQ(Brightness(clamped, 2, 0), Brightness(clamped, 0, 0));
}

TEST(DifferencePicture, HasALegendThatNamesTheTop) {
  const std::vector<float> errors(4, 0.0f);
  const BytePicture one = DrawErrors({2, errors, 1, "FLIP 0.1"}),
                    five = DrawErrors({2, errors, 5, "FLIP 0.1"});
  EXPECT_GE(one.width, 160) << "narrow pictures get a border";
  EXPECT_GT(one.height, 2 + 20);
  EXPECT_EQ(one.values.size(), static_cast<size_t>(one.width * one.height * 3));
  EXPECT_NE(one.values, five.values);
  std::set<int> bar;
  for (int x = 0; x < one.width; ++x) bar.insert(Brightness(one, x, 2 + 6));
  EXPECT_GT(bar.size(), 100u) << "a bar of all colours";
}

TEST(LargestDifferences, AreThoseOfTheCommonChannels) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const auto differences =
      LargestDifferences(Row({"N.X", "N.Y"}, {1, 2, 3, nan, nan, 1, infinity, 0}),
                         Row({"N.X", "N.Y", "Z"}, {2, 4, 9, 3, nan, 9, 0, 1, 9, infinity, 0, 9}));
  EXPECT_EQ(differences, (std::vector<float>{2, 0, infinity, 0}));
}

TEST(TopOfErrors, LeavesOutTheLargestHundredth) {
  std::vector<float> errors(1000, 1);
  for (size_t i = 0; i < 10; ++i) errors[i * 7] = 1e9f;
  EXPECT_EQ(TopOf(errors), 1);
  errors[3] = 1e9f;
  EXPECT_EQ(TopOf(errors), 1e9f);
  EXPECT_EQ(TopOf({0, 0}), 1);
  EXPECT_EQ(TopOf({}), 1);
  EXPECT_EQ(TopOf({std::numeric_limits<float>::infinity()}), 1);
}

}  // namespace
}  // namespace tessera
