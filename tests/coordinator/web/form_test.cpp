#include "coordinator/web/form.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using Fields = std::map<std::string, std::string>;

TEST(Form, IsDecoded) {
  EXPECT_EQ(*ParseForm("a=1&b=x+y%2b%C3%A4&c&=d"),
            (Fields{{"a", "1"}, {"b", "x y+\xc3\xa4"}, {"c", ""}, {"", "d"}}));
  EXPECT_EQ(*ParseForm(""), Fields());
}

TEST(Form, WhatIsMalformedRepeatedOrTooMuchIsRefused) {
  for (const char* body : {"a=%", "a=%4", "a=%4g", "a=%+1", "a=1&a=2", "a=1&%61=2"})
    EXPECT_FALSE(ParseForm(body)) << body;
  std::string body;
  for (size_t i = 0; i < kFormFieldsMax; ++i) body += "a" + std::to_string(i) + "=1&";
  EXPECT_TRUE(ParseForm(body));
  EXPECT_FALSE(ParseForm(body + "last=1"));
}

TEST(CookieValue, FindsACookieByItsWholeNameAlone) {
  EXPECT_EQ(CookieValue("a=1; session=x=y; b=2", "session"), "x=y");
  EXPECT_EQ(CookieValue("session=x", "session"), "x");
  for (const char* cookies : {"", "session", "my-session=x", "Session=x", "session =x", "b=session=x"})
    EXPECT_EQ(CookieValue(cookies, "session"), "") << cookies;
}

// The first may be one that another program on this host has set.
TEST(CookieValue, OneThatIsThereTwiceCountsAsMissing) {
  EXPECT_EQ(CookieValue("session=x; session=y", "session"), "");
}

}  // namespace
}  // namespace tessera
