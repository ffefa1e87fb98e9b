#include "proto/wire/address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Address, ReadsWhatItWrites) {
  for (const char* text : {"localhost:7000", "127.0.0.1:0", "[::1]:65535", "render-7.example:80",
                           "unix:/tmp/a b", "unix:relative"}) {
    const auto address = ParseAddress(text, "--listen");
    ASSERT_TRUE(address) << text;
    EXPECT_EQ(address->Text(), text);
  }
}

TEST(Address, RefusesWhatIsNone) {
  for (const std::string text : {"", "localhost", ":80", "a:b:80", "a:65536", "a:-1", "a:80x", "a:", "::1:80",
                                 "[::1]", "[zz]:80", "unix:", "http://a:80", "a b:80"}) {
    const auto address = ParseAddress(text, "--coordinator");
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(address.error().message, testing::StartsWith("--coordinator: bad address \"" + text + "\""))
        << text;
  }
  EXPECT_FALSE(ParseAddress("unix:" + std::string(108, 'a'), "x"));
  EXPECT_TRUE(ParseAddress("unix:" + std::string(107, 'a'), "x"));
  EXPECT_FALSE(ParseAddress(std::string(254, 'a') + ":1", "x"));
}

TEST(Address, KnowsWhatOnlyThisMachineReaches) {
  for (const char* local : {"localhost:1", "127.0.0.1:1", "127.8.9.1:1", "[::1]:1", "unix:/x"}) {
    EXPECT_TRUE(ParseAddress(local, "x")->IsLocal()) << local;
  }
  for (const char* open : {"0.0.0.0:1", "[::]:1", "10.0.0.1:1", "127.evil.example:1", "example:1"}) {
    EXPECT_FALSE(ParseAddress(open, "x")->IsLocal()) << open;
  }
}

}  // namespace
}  // namespace tessera
