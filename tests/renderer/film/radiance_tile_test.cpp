#include "film/radiance_tile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace tessera {
namespace {

RadianceTile SmallTile() {
  RadianceTile tile;
  tile.bounds = {30, 40, 33, 42};
  tile.range = {12, 4};
  tile.channels = 4;
  for (int i = 0; i < 24; ++i) tile.sums.push_back(static_cast<float>(i) * 0.37f - 2.0f);
  return tile;
}

// Bytes with a field of the header replaced and the check sum made right again.
std::string WithField(size_t offset, int32_t value) {
  std::string bytes = EncodeRadianceTile(SmallTile());
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  const std::string_view body(bytes.data(), bytes.size() - 8);
  const Digest digest = Sha256(body);
  std::memcpy(bytes.data() + body.size(), digest.bytes.data(), 8);
  return bytes;
}

TEST(RadianceTileCodec, GivesBackWhatWasEncoded) {
  const Result<RadianceTile> decoded = DecodeRadianceTile(EncodeRadianceTile(SmallTile()));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(*decoded, SmallTile());
}

TEST(RadianceTileCodec, RefusesEveryFlippedByte) {
  const std::string bytes = EncodeRadianceTile(SmallTile());
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (int flip : {1, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      EXPECT_FALSE(DecodeRadianceTile(damaged)) << "byte " << i << " flipped by " << flip;
    }
  }
}

TEST(RadianceTileCodec, RefusesEveryTruncationAndWhatFollows) {
  const std::string bytes = EncodeRadianceTile(SmallTile());
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(DecodeRadianceTile(bytes.substr(0, size)));
  EXPECT_FALSE(DecodeRadianceTile(bytes + "x"));
}

TEST(RadianceTileCodec, ChecksEveryFieldEvenWhenTheCheckSumIsRight) {
  const struct {
    size_t offset;
    int32_t value;
    const char* message;
  } cases[] = {
      {4, 2, "version 2"},
      {8, -1, "bounds"},
      {8, 33, "bounds"},
      {12, 42, "bounds"},
      {16, 70000, "bounds"},
      {16, 30 + 257, "bounds"},
      {24, 13, "dyadic"},
      {28, 3, "dyadic"},
      {28, 0, "dyadic"},
      {28, -4, "dyadic"},
      {32, 0, "channels"},
      {32, 257, "channels"},
      {32, 5, "bytes of sums"},
      {32, 3, "bytes of sums"},
      {36, 0x7f800000, "not finite"},
      {36, 0x7fc00000, "not finite"},
  };
  for (const auto& bad : cases) {
    const Result<RadianceTile> decoded = DecodeRadianceTile(WithField(bad.offset, bad.value));
    ASSERT_FALSE(decoded) << bad.offset << ' ' << bad.value;
    EXPECT_THAT(decoded.error().message, testing::HasSubstr(bad.message)) << bad.offset << ' ' << bad.value;
  }
}

TEST(RadianceTileDigest, TellsTheSmallestDifference) {
  RadianceTile tile = SmallTile();
  const Digest before = RadianceTileDigest(tile);
  EXPECT_EQ(before, RadianceTileDigest(SmallTile()));
  tile.sums[5] = std::nextafter(tile.sums[5], std::numeric_limits<float>::infinity());
  EXPECT_NE(before, RadianceTileDigest(tile));
}

}  // namespace
}  // namespace tessera
