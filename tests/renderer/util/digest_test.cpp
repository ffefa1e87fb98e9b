#include "renderer/util/digest.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

#include "renderer/util/hash.h"
#include "renderer/util/result.h"

namespace tessera {
namespace {

TEST(Digest, IsTheSha256OfTheStandard) {
  EXPECT_EQ(Sha256("").Hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256("abc").Hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Digest, OfPiecesIsThatOfTheWhole) {
  Sha256Stream stream;
  stream.Add("a");
  stream.Add("");
  stream.Add("bc");
  EXPECT_EQ(stream.Finish(), Sha256("abc"));
}

TEST(Digest, IsReadFromExactly64HexadecimalDigits) {
  const std::string hex = Sha256("abc").Hex();
  EXPECT_EQ(Digest::FromHex(hex), Sha256("abc"));
  EXPECT_FALSE(Digest::FromHex(hex.substr(1)).has_value());
  EXPECT_FALSE(Digest::FromHex(hex + "0").has_value());
  std::string bad = hex;
  bad[10] = 'g';
  EXPECT_FALSE(Digest::FromHex(bad).has_value());
  EXPECT_FALSE(Digest::FromHex("").has_value());
}

TEST(Hash, EveryInputBitChangesHalfOfTheOutputBits) {
  double flipped_total = 0;
  for (uint64_t v = 1; v <= 64; ++v) {
    for (int bit = 0; bit < 64; ++bit) {
      const int flipped = std::popcount(MixBits(v * 0x12345) ^ MixBits((v * 0x12345) ^ (uint64_t{1} << bit)));
      EXPECT_GT(flipped, 8);
      EXPECT_LT(flipped, 56);
      flipped_total += flipped;
    }
  }
  EXPECT_NEAR(flipped_total / (64 * 64), 32, 0.25);  // standard error 4 / 64
}

TEST(Hash, DependsOnEveryValueAndTheirOrder) {
  std::set<uint64_t> seen;
  for (uint64_t a = 0; a < 30; ++a) {
    for (uint64_t b = 0; b < 30; ++b) {
      for (uint64_t c = 0; c < 30; ++c) seen.insert(Hash(a, b, c));
    }
  }
  EXPECT_EQ(seen.size(), 27000u);
  EXPECT_NE(Hash(1, 0), Hash(1));
}

TEST(Hash, ExtendedHashIsThatOfAllTheIntegers) {
  EXPECT_EQ(ExtendHash(Hash(1, 2), 3, 4), Hash(1, 2, 3, 4));
  EXPECT_EQ(ExtendHash(0, 1, 2), Hash(1, 2));
}

TEST(Hash, UniformFloatsLieBelowOne) {
  EXPECT_EQ(UniformFloat(0), 0);
  EXPECT_EQ(UniformFloat(0xffffffffu), kOneMinusEpsilon);
  EXPECT_LT(kOneMinusEpsilon, 1);
  EXPECT_EQ(std::nextafter(kOneMinusEpsilon, 2.f), 1);
  double sum = 0, squares = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double u = UniformFloat(static_cast<uint32_t>(Hash(7, i)));
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / kCount, 1.0 / 2, 0.004);  // standard error 0.0009
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 0.004);
}

TEST(Result, HoldsAValueOrAnError) {
  Result<std::string> value(std::string("x"));
  EXPECT_TRUE(value.has_value());
  EXPECT_EQ(*value, "x");
  EXPECT_EQ(value->size(), 1u);
  const Result<std::string> error(BadInput("wrong"));
  EXPECT_FALSE(error);
  EXPECT_EQ(error.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(error.error().message, "wrong");
  const Result<void> done, failed(Failed("broken"));
  EXPECT_TRUE(done.has_value());
  EXPECT_FALSE(failed.has_value());
  EXPECT_EQ(static_cast<int>(failed.error().kind), 1);
}

TEST(ResultDeathTest, TakingWhatIsNotThereStopsTheProgram) {
  Result<int> error(Failed("broken"));
  EXPECT_DEATH(static_cast<void>(error.value()), "has_value");
  const Result<int> value(1);
  EXPECT_DEATH(static_cast<void>(value.error()), "has_value");
}

}  // namespace
}  // namespace tessera
