#include "renderer/description/number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace tessera {
namespace {

TEST(Number, FloatsAreReadAsPbrtWritesThem) {
  EXPECT_EQ(ParseFloat("0"), 0.f);
  EXPECT_EQ(ParseFloat("1."), 1.f);
  EXPECT_EQ(ParseFloat(".5"), .5f);
  EXPECT_EQ(ParseFloat("+3"), 3.f);
  EXPECT_EQ(ParseFloat("-1e5"), -1e5f);
  EXPECT_EQ(ParseFloat("1E+05"), 1e5f);
  EXPECT_EQ(ParseFloat("007"), 7.f);
  EXPECT_EQ(ParseFloat("12345678901234567890"), 12345678901234567890.f);
  EXPECT_EQ(ParseFloat("0x1F"), 31.f);
  EXPECT_EQ(ParseFloat("0.1"), 0.1f);
  EXPECT_EQ(ParseFloat("3.4028234e38"), std::numeric_limits<float>::max());
  EXPECT_TRUE(std::signbit(*ParseFloat("-0")));
}

TEST(Number, FloatsThatAreNoneAreRefused) {
  for (const char* text : {"",     ".",   "-",  "+",  "e5",  "1e",  "1e+", "inf", "-inf", "nan",  "infinity",
                           "1..2", "1,5", "1f", "0x", "0xg", "++1", "+-1", "- 1", "--1",  "true", "1 "}) {
    EXPECT_FALSE(ParseFloat(text).has_value()) << text;
  }
}

TEST(Number, FloatsTooLargeAreRefusedAndTooSmallAreZero) {
  for (const char* text : {"1e39", "-1e39", "3.5e38", "1e400", "1e99999999999", "0xffffffffffffffffff"}) {
    EXPECT_FALSE(ParseFloat(text).has_value()) << text;
  }
  EXPECT_FALSE(ParseFloat("1" + std::string(500, '0')).has_value());
  for (const char* text : {"1e-60", "-1e-60", "1e-400", "1e-99999999999"}) {
    EXPECT_EQ(ParseFloat(text), 0.f) << text;
  }
  EXPECT_EQ(ParseFloat("0." + std::string(500, '0') + "1"), 0.f);
  EXPECT_EQ(ParseFloat("1e-40"), 1e-40f);  // a denormal
}

TEST(Number, EveryFloatSurvivesBeingWrittenWithNineDigits) {
  std::mt19937 engine(1);
  for (int i = 0; i < 20000; ++i) {
    const uint32_t bits = engine();
    float value = 0;
    static_assert(sizeof bits == sizeof value);
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    char text[64];
    std::snprintf(text, sizeof text, "%.9g", static_cast<double>(value));
    EXPECT_EQ(ParseFloat(text), value) << text;
  }
}

TEST(Number, IntegersHave32Bits) {
  EXPECT_EQ(ParseInteger("2147483647"), 2147483647);
  EXPECT_EQ(ParseInteger("-2147483648"), std::numeric_limits<int>::min());
  EXPECT_EQ(ParseInteger("+12"), 12);
  EXPECT_EQ(ParseInteger("-0"), 0);
  for (const char* text : {"", "-", "+", "+-1", "2147483648", "-2147483649", "1.0", "1e3", "0x10", "1 "}) {
    EXPECT_FALSE(ParseInteger(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace tessera
