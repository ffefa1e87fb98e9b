#include "proto/identity/secrets.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Secrets, AreRandom) {
  EXPECT_EQ(RandomSecret().size(), 64u);
  EXPECT_NE(RandomSecret(), RandomSecret());
}

TEST(Secrets, AreComparedAsAWhole) {
  EXPECT_TRUE(AreEqualSecrets("abc", "abc"));
  EXPECT_TRUE(AreEqualSecrets("", ""));
  for (const char* other : {"", "ab", "abd", "abcd", "Abc"}) EXPECT_FALSE(AreEqualSecrets("abc", other));
}

// RFC 4231, test case 2.
TEST(Secrets, KeyedDigestsAreThoseOfHmac) {
  EXPECT_EQ(KeyedDigest("Jefe", "what do ya want for nothing?").Hex(),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
}

// RFC 4648, section 10.
TEST(Secrets, Base64HasPadding) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace tessera
