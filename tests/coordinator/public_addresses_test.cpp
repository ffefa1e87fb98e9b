#include "coordinator/public_addresses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::ElementsAre;

Address Listening(const std::string& text) {
  return *ParseAddress(text, "test");
}

TEST(PublicAddresses, AWildcardStandsForTheNamesOfTheMachineNumbersFirst) {
  EXPECT_THAT(PublicAddresses({Listening("0.0.0.0:7700")}, {"blade", "10.0.0.5", "fe80::1"}, false),
              ElementsAre("10.0.0.5:7700", "blade:7700", "[fe80::1]:7700"));
}

TEST(PublicAddresses, NamesThatTheUserChoseComeFirst) {
  EXPECT_THAT(PublicAddresses({Listening("10.0.0.5:7700")}, {"farm.example"}, true),
              ElementsAre("farm.example:7700", "10.0.0.5:7700"));
}

TEST(PublicAddresses, WhatOnlyThisMachineReachesComesLast) {
  EXPECT_THAT(PublicAddresses({Listening("127.0.0.1:7700"), Listening("unix:/s"), Listening("10.0.0.5:7701")},
                              {"blade"}, false),
              ElementsAre("10.0.0.5:7701", "127.0.0.1:7700"));
}

}  // namespace
}  // namespace tessera
