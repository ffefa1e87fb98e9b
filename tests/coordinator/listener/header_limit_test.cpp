#include "coordinator/listener/header_limit.h"

#include <gtest/gtest.h>

#include <string>

namespace tessera {
namespace {

constexpr char kData = 0, kHeaders = 1, kSettings = 4, kContinuation = 9;
constexpr char kEndHeaders = 4;

std::string Preface() {
  return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
}

std::string Frame(char type, char flags, size_t size) {
  std::string frame{static_cast<char>(size >> 16),
                    static_cast<char>(size >> 8),
                    static_cast<char>(size),
                    type,
                    flags,
                    0,
                    0,
                    0,
                    1};
  // Bytes that would be the head of a frame with headers if they were taken for one.
  return frame + std::string(size, kHeaders);
}

bool Take(HeaderLimit& limit, const std::string& bytes) {
  return limit.Take({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

TEST(HeaderLimit, ManyRequestsWithTheirDataPass) {
  HeaderLimit limit;
  EXPECT_TRUE(Take(limit, Preface() + Frame(kSettings, 0, 18)));
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(Take(limit, Frame(kHeaders, 0, 400) + Frame(kContinuation, kEndHeaders, 400)));
    ASSERT_TRUE(Take(limit, Frame(kData, 0, 16384)));
  }
}

TEST(HeaderLimit, HeadersWithoutAnEndAreRefusedForGood) {
  HeaderLimit limit;
  EXPECT_TRUE(Take(limit, Preface() + Frame(kHeaders, 0, 100)));
  size_t sent = 0;
  while (Take(limit, Frame(kContinuation, 0, 100))) sent += 100;
  EXPECT_GT(sent, kHeaderBlockBytesMax / 2);
  EXPECT_LT(sent, kHeaderBlockBytesMax);
  EXPECT_FALSE(Take(limit, Frame(kHeaders, kEndHeaders, 1)));
}

TEST(HeaderLimit, FramesWithoutAPayloadCount) {
  HeaderLimit limit;
  EXPECT_TRUE(Take(limit, Preface() + Frame(kHeaders, 0, 0)));
  std::string empty;
  for (size_t i = 0; i < kHeaderBlockBytesMax / 9; ++i) empty += Frame(kContinuation, 0, 0);
  EXPECT_FALSE(Take(limit, empty));
}

TEST(HeaderLimit, OneFrameIsRefusedByItsHead) {
  HeaderLimit limit;
  EXPECT_TRUE(Take(limit, Preface()));
  EXPECT_FALSE(Take(limit, Frame(kHeaders, kEndHeaders, kHeaderBlockBytesMax + 1).substr(0, 9)));
}

TEST(HeaderLimit, ItDoesNotMatterHowTheBytesAreCut) {
  const std::string good = Preface() + Frame(kHeaders, 0, kHeaderBlockBytesMax - 200) +
                           Frame(kContinuation, kEndHeaders, 100) + Frame(kData, 0, 70000);
  const std::string bad = good + Frame(kHeaders, 0, kHeaderBlockBytesMax) + Frame(kContinuation, 0, 0);
  for (const size_t piece : {1, 2, 7, 9, 1000, 16384}) {
    HeaderLimit limit;
    size_t at = 0;
    while (at < bad.size() && Take(limit, bad.substr(at, piece))) at += piece;
    EXPECT_GE(at + piece, good.size()) << piece;
    EXPECT_LE(at, good.size() + 9) << piece;
  }
}

TEST(HeaderLimit, WhatIsNotHttp2IsNobodysConcern) {
  HeaderLimit limit;
  EXPECT_TRUE(Take(limit, "PRI * HTTP/1.1\r\n"));
  EXPECT_TRUE(Take(limit, Frame(kHeaders, 0, 100000)));
}

}  // namespace
}  // namespace tessera
