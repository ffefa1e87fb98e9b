#include "renderer/film/radiance_tile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace tessera {
namespace {

RadianceTile SmallTile() {
  RadianceTile tile;
  tile.bounds = {30, 40, 33, 42};
  tile.range = {12, 4};
  tile.shape = {4};
  for (int i = 0; i < 24; ++i) tile.sums.push_back(static_cast<float>(i) * 0.37f - 2.0f);
  return tile;
}

// Of its six pixels three are held: 0, 2 and 5.
RadianceTile SparseTile() {
  RadianceTile tile = SmallTile();
  for (const size_t pixel : {1, 3, 4}) std::fill_n(&tile.sums[pixel * 4], 4, 0.0f);
  return tile;
}

// As the answer to the unit of SmallTile and SparseTile.
Result<RadianceTile> Decode(std::string_view bytes) {
  const RadianceTile tile = SmallTile();
  return DecodeRadianceTile(bytes, {tile.bounds, tile.range, tile.shape});
}

// Bytes of a tile with some replaced and the check sum made right again.
template <typename T>
std::string With(const RadianceTile& tile, size_t offset, T value) {
  std::string bytes = EncodeRadianceTile(tile);
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  const std::string_view body(bytes.data(), bytes.size() - 8);
  const Digest digest = Sha256(body);
  std::memcpy(bytes.data() + body.size(), digest.bytes.data(), 8);
  return bytes;
}

TEST(RadianceTileCodec, GivesBackWhatWasEncoded) {
  const Result<RadianceTile> decoded = Decode(EncodeRadianceTile(SmallTile()));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(*decoded, SmallTile());
}

TEST(RadianceTileCodec, PixelsThatAreZerosTakeNoRoom) {
  const std::string bytes = EncodeRadianceTile(SparseTile());
  EXPECT_EQ(bytes.size(), EncodeRadianceTile(SmallTile()).size() + 1 - 3 * 4 * sizeof(float));
  const Result<RadianceTile> decoded = Decode(bytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(*decoded, SparseTile());
  RadianceTile empty = SmallTile();
  std::ranges::fill(empty.sums, 0.0f);
  EXPECT_EQ(*Decode(EncodeRadianceTile(empty)), empty);
}

TEST(RadianceTileCodec, MinusZeroSurvives) {
  RadianceTile tile = SparseTile();
  tile.sums[4] = -0.0f;
  const Result<RadianceTile> decoded = Decode(EncodeRadianceTile(tile));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(std::signbit(decoded->sums[4]));
}

TEST(RadianceTileCodec, RefusesAMaskThatDoesNotFit) {
  const struct {
    unsigned char mask;
    const char* message;
  } cases[] = {
      {0b100001, "another number"}, {0b100111, "another number"}, {0, "no pixels"}, {0b1100001, "beyond"}};
  for (const auto& bad : cases) {
    const Result<RadianceTile> decoded = Decode(With(SparseTile(), 40, bad.mask));
    ASSERT_FALSE(decoded) << int{bad.mask};
    EXPECT_THAT(decoded.error().message, testing::HasSubstr(bad.message));
  }
  EXPECT_TRUE(Decode(With(SparseTile(), 40, static_cast<unsigned char>(0b001011))))
      << "other pixels, as many";
}

TEST(RadianceTile, CountsTheSamplesOfThePixelsThatItHolds) {
  EXPECT_EQ(PixelSamples(SmallTile()), 6u * 4);
  EXPECT_EQ(PixelSamples(SparseTile()), 3u * 4);
}

TEST(RadianceTileCodec, RefusesEveryFlippedByte) {
  const std::string bytes = EncodeRadianceTile(SparseTile());
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (int flip : {1, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      EXPECT_FALSE(Decode(damaged)) << "byte " << i << " flipped by " << flip;
    }
  }
}

TEST(RadianceTileCodec, RefusesEveryTruncationAndWhatFollows) {
  const std::string bytes = EncodeRadianceTile(SparseTile());
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(Decode(bytes.substr(0, size)));
  EXPECT_FALSE(Decode(bytes + "x"));
}

TEST(RadianceTileCodec, ChecksEveryFieldEvenWhenTheCheckSumIsRight) {
  const struct {
    size_t offset;
    int32_t value;
    const char* message;
  } cases[] = {
      {4, 1, "version 1"},
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
      {32, 5, "has 5 channels, expected 4"},
      {32, 3, "has 3 channels, expected 4"},
      {36, 5, "bytes of values"},
      {36, 7, "bytes of values"},
      {36, -1, "bytes of values"},
      {40, 0x7f800000, "not finite"},
      {40, 0x7fc00000, "not finite"},
      {40, 0x7f7fffff, "too large"},
  };
  for (const auto& bad : cases) {
    const Result<RadianceTile> decoded = Decode(With(SmallTile(), bad.offset, bad.value));
    ASSERT_FALSE(decoded) << bad.offset << ' ' << bad.value;
    EXPECT_THAT(decoded.error().message, testing::HasSubstr(bad.message)) << bad.offset << ' ' << bad.value;
  }
}

TEST(RadianceTileCodec, RefusesATileThatWasNotRequestedBeforeItTakesMemory) {
  // 8 KB that stand for 64 MB.
  RadianceTile huge;
  huge.bounds = {0, 0, kTileSizeMax, kTileSizeMax};
  huge.range = {0, 4};
  huge.shape = {255};
  huge.sums.resize(static_cast<size_t>(huge.bounds.area()) * huge.shape.stride());
  const std::string bytes = EncodeRadianceTile(huge);
  EXPECT_LT(bytes.size(), 10'000u);
  EXPECT_THAT(Decode(bytes).error().message, testing::HasSubstr("bounds"));
  const RadianceTile tile = SmallTile();
  const auto decode = [&](const TileRequest& request) {
    return DecodeRadianceTile(EncodeRadianceTile(tile), request);
  };
  EXPECT_TRUE(decode({tile.bounds, tile.range, tile.shape}));
  EXPECT_FALSE(decode({{0, 0, 3, 2}, tile.range, tile.shape}));
  EXPECT_FALSE(decode({tile.bounds, {8, 4}, tile.shape}));
  EXPECT_FALSE(decode({tile.bounds, tile.range, {3}}));
  EXPECT_FALSE(decode({tile.bounds, tile.range, {3, 1}}));
}

TEST(RadianceTileCodec, TheDecodedSizeIsKnownBeforeDecoding) {
  for (const RadianceTile& tile : {SmallTile(), SparseTile()}) {
    const std::string bytes = EncodeRadianceTile(tile);
    EXPECT_GE(DecodedSize(bytes), tile.sums.size() * sizeof(float));
    EXPECT_EQ(DecodedSize(bytes), DecodedSize(tile.bounds, tile.shape, bytes.size()));
  }
  EXPECT_EQ(DecodedSize("not a tile"), 10u);
  EXPECT_LT(DecodedSize(With(SmallTile(), 16, -1)), 1000u);
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
