#include "renderer/film/pixel_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(PixelMask, WithoutChoiceHasAllPixelsOfAnyRectangle) {
  const PixelMask all;
  EXPECT_TRUE(all.HasAll() && all.Has(0) && all.Has(100'000));
  EXPECT_EQ(all.Count(12), 12u);
  EXPECT_EQ(all.Bytes(), "");
  EXPECT_EQ(PixelMask::Of(std::vector<bool>(12, true)), all) << "one mask, one form";
}

TEST(PixelMask, HasWhatWasChosenAndSurvivesItsBytes) {
  for (const size_t pixels : {1, 7, 8, 9, 64, 75}) {
    std::vector<bool> chosen(pixels);
    for (size_t i = 0; i < pixels; ++i) chosen[i] = i % 3 == 1 || i + 1 == pixels;
    const PixelMask mask = PixelMask::Of(chosen);
    for (size_t i = 0; i < pixels; ++i) EXPECT_EQ(mask.Has(i), chosen[i]) << i << " of " << pixels;
    EXPECT_EQ(mask.Count(pixels), static_cast<size_t>(std::ranges::count(chosen, true)));
    const auto read = PixelMask::Read(mask.Bytes(), pixels);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, mask);
  }
}

TEST(PixelMask, MayHaveNone) {
  const PixelMask none = PixelMask::Of(std::vector<bool>(10));
  EXPECT_EQ(none.Count(10), 0u);
  EXPECT_FALSE(none.HasAll() || none.Has(3));
}

TEST(PixelMask, RefusesBytesThatAreNoMaskOfTheRectangle) {
  EXPECT_THAT(PixelMask::Read("a", 9).error().message, testing::HasSubstr("bytes"));
  EXPECT_THAT(PixelMask::Read("abc", 16).error().message, testing::HasSubstr("bytes"));
  EXPECT_THAT(PixelMask::Read("\x20", 5).error().message, testing::HasSubstr("beyond"));
  EXPECT_THAT(PixelMask::Read(std::string(2, '\0'), 9).error().message, testing::HasSubstr("no pixels"));
  EXPECT_EQ(*PixelMask::Read("\x1f", 5), PixelMask()) << "all of them";
}

}  // namespace
}  // namespace tessera
