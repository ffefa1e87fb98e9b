#include "proto/shell/values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(Sizes, UnitsArePowersOf1024InEitherCase) {
  const std::pair<const char*, uint64_t> table[] = {
      {"0", 0},
      {"17", 17},
      {"17B", 17},
      {"500M", uint64_t{500} << 20},
      {"20G", uint64_t{20} << 30},
      {"20gb", uint64_t{20} << 30},
      {"20GiB", uint64_t{20} << 30},
      {"1.5G", uint64_t{1536} << 20},
      {"0.5k", 512},
      {"2T", uint64_t{2} << 40},
      {"18446744073709551615", UINT64_MAX},
      {"16777215T", uint64_t{16777215} << 40},
  };
  for (const auto& [word, bytes] : table) {
    const auto size = ParseSize("--size", word);
    ASSERT_TRUE(size) << word << ": " << size.error().message;
    EXPECT_EQ(*size, bytes) << word;
  }
}

TEST(Sizes, NegativeMalformedAndTooLargeSizesAreRefused) {
  for (const char* word : {"", "G", "-1", "-1G", "+1G", "1.5.1G", ".", "1e3", "3X", "3GG", "1 G", "1Gi", "G1",
                           "nan", "inf", "18446744073709551616", "16777216T", "16777216.5T", "0x10"}) {
    const auto size = ParseSize("--cache-size", word);
    ASSERT_FALSE(size) << word << " is " << *size;
    EXPECT_EQ(size.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(size.error().message, HasSubstr("--cache-size: \"" + std::string(word) + "\" is not a size"));
  }
}

TEST(Sizes, LessThanTheMinimumIsRefused) {
  EXPECT_TRUE(ParseSize("--size", "1M", 1 << 20));
  EXPECT_EQ(ParseSize("--size", "1000K", 1 << 20).error().message, "--size: \"1000K\" is less than 1M");
}

TEST(Sizes, AreWrittenAsTheyAreRead) {
  for (const char* text : {"0", "1", "1023", "1K", "1536M", "100G", "1048577", "16777215T"})
    EXPECT_EQ(SizeText(*ParseSize("--size", text)), text);
}

TEST(Values, NumbersOutsideTheirRangeAreRefusedWithTheRange) {
  EXPECT_EQ(*ParseInteger("--n", "-3", -3, 5), -3);
  for (const char* word : {"6", "-4", "", "1.0", "1x", "99999999999999999999"})
    EXPECT_THAT(ParseInteger("--n", word, -3, 5).error().message, HasSubstr("a whole number from -3 to 5"));
  EXPECT_EQ(*ParseNumber("--x", "0.25", 0), 0.25);
  for (const char* word : {"-0.1", "nan", "inf", "1e999", "1,5"})
    EXPECT_THAT(ParseNumber("--x", word, 0).error().message, HasSubstr("a number of at least 0"));
}

TEST(Values, AnUnknownChoiceIsRefusedWithASuggestion) {
  static constexpr std::string_view kChoices[] = {"embree", "bvh"};
  EXPECT_EQ(*ParseChoice("--a", "bvh", kChoices), "bvh");
  EXPECT_EQ(ParseChoice("--a", "embre", kChoices).error().message,
            "--a: \"embre\" is not one of embree, bvh (did you mean \"embree\"?)");
}

}  // namespace
}  // namespace tessera
