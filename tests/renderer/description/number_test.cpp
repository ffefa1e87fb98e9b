#include "renderer/description/number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

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

template <typename Float>
Float Read(const std::string& text) {
  Float value = 77;
  const auto [stop, error] = ReadNumber(text.data(), text.data() + text.size(), value);
  EXPECT_EQ(error, std::errc()) << text;
  EXPECT_EQ(stop, text.data() + text.size()) << text;
  return value;
}

template <typename Float>
void ExpectTinyIsZeroAndHugeIsInfinite() {
  const std::string zeros(500, '0');
  const std::vector<std::string> tiny{"2.3e-4999",
                                      "1e-9999",
                                      "1e-99999999999999999999",
                                      "." + zeros + "1",
                                      "0." + zeros + "5",
                                      "." + zeros + "3e+9",
                                      zeros + "." + zeros + "1e2"};
  for (const std::string& text : tiny) {
    EXPECT_EQ(Read<Float>(text), 0) << text;
    EXPECT_FALSE(std::signbit(Read<Float>(text)));
    EXPECT_EQ(Read<Float>("+" + text), 0);
    EXPECT_TRUE(std::signbit(Read<Float>("-" + text)));
  }
  constexpr Float kInfinity = std::numeric_limits<Float>::infinity();
  const std::vector<std::string> huge{"1e400",
                                      "1e99999999999999999999",
                                      "1" + zeros,
                                      "1" + zeros + "e-9",
                                      zeros + "7" + zeros,
                                      "0.1" + zeros + "e+600"};
  for (const std::string& text : huge) {
    EXPECT_EQ(Read<Float>(text), kInfinity) << text;
    EXPECT_EQ(Read<Float>("-" + text), -kInfinity) << text;
  }
}

TEST(ReadNumber, NumbersBeyondTheRangeOfTheirTypeAreZeroOrInfinite) {
  ExpectTinyIsZeroAndHugeIsInfinite<float>();
  ExpectTinyIsZeroAndHugeIsInfinite<double>();
  EXPECT_EQ(Read<float>("2.2958450216584675e-49"), 0);
  EXPECT_EQ(Read<float>("1e-40"), 1e-40f);
  EXPECT_EQ(Read<float>("1e39"), std::numeric_limits<float>::infinity());
  EXPECT_EQ(Read<double>("2.2958450216584675e-49"), 2.2958450216584675e-49);
  EXPECT_EQ(Read<double>("4.9e-324"), std::numeric_limits<double>::denorm_min());
}

TEST(ReadNumber, StopsWhereTheNumberEnds) {
  for (const std::string text : {"1e-60", "+7", "-2.5", "12"}) {
    const std::string more = text + " 8";
    double value = 0;
    EXPECT_EQ(ReadNumber(more.data(), more.data() + more.size(), value).ptr, more.data() + text.size());
  }
  for (const std::string text : {"", "+", "+-1", "-+1", "x"}) {
    float value = 0;
    EXPECT_EQ(ReadNumber(text.data(), text.data() + text.size(), value).ec, std::errc::invalid_argument)
        << text;
  }
  int number = 0;
  const std::string large = "3000000000";
  EXPECT_EQ(ReadNumber(large.data(), large.data() + large.size(), number).ec, std::errc::result_out_of_range);
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
