#include "renderer/film/cryptomatte.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(Cryptomatte, HashesAreThoseOfTheReference) {
  EXPECT_EQ(MurmurHash3(""), 0u);
  EXPECT_EQ(MurmurHash3("hello"), 0x248bfa47u);
  EXPECT_EQ(MurmurHash3("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(MurmurHash3("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(Cryptomatte, IdsAreThoseOfFilesOfOtherRenderers) {
  EXPECT_EQ(std::bit_cast<uint32_t>(MatteId("bunny")), 0x13851a76u);
  EXPECT_EQ(std::bit_cast<uint32_t>(MatteId("default")), 0x42c9679fu);
}

TEST(Cryptomatte, IdsAreNormalNumbers) {
  EXPECT_TRUE(std::isnormal(MatteId(""))) << "whose hash is 0";
  int changed = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::string name = "object." + std::to_string(i);
    EXPECT_TRUE(std::isnormal(MatteId(name))) << name;
    changed += std::bit_cast<uint32_t>(MatteId(name)) != MurmurHash3(name);
  }
  EXPECT_GT(changed, 0) << "an exponent of 0 or 255 must have occurred";
}

TEST(Cryptomatte, ManifestListsEachNameOnceAndEscapesIt) {
  const MatteManifest manifest = MakeManifest({"a \"b\"", "bunny", "c\\", "bunny"});
  EXPECT_EQ(manifest.listed, 3u);
  EXPECT_EQ(manifest.total, 3u);
  EXPECT_THAT(manifest.json, testing::StartsWith(R"({"a \"b\"":")"));
  EXPECT_THAT(manifest.json, HasSubstr(R"("bunny":"13851a76")"));
  EXPECT_THAT(manifest.json, HasSubstr(R"("c\\":")"));
  EXPECT_EQ(MakeManifest({}).json, "{}");
}

TEST(Cryptomatte, NamesBeyondTheBoundAreLeftOutFromTheEnd) {
  std::vector<std::string> names;
  for (int i = 0; i < 5'000; ++i) names.push_back("tree." + std::to_string(i));
  const MatteManifest manifest = MakeManifest(names);
  EXPECT_EQ(manifest.total, 5'000u);
  EXPECT_LT(manifest.listed, 5'000u);
  EXPECT_LE(manifest.json.size(), kManifestBytesMax);
  EXPECT_GT(manifest.json.size(), kManifestBytesMax - 100);
  EXPECT_THAT(manifest.json, HasSubstr("\"" + names[manifest.listed - 1] + "\":"));
  EXPECT_THAT(manifest.json, Not(HasSubstr("\"" + names[manifest.listed] + "\":")));
}

TEST(Cryptomatte, HeaderNamesTheLayer) {
  std::map<std::string, std::string> attributes;
  AddMatteAttributes("CryptoObject", MakeManifest({"bunny"}), attributes);
  EXPECT_EQ(attributes, (std::map<std::string, std::string>{
                            {"cryptomatte/3ae39a5/name", "CryptoObject"},
                            {"cryptomatte/3ae39a5/hash", "MurmurHash3_32"},
                            {"cryptomatte/3ae39a5/conversion", "uint32_to_float32"},
                            {"cryptomatte/3ae39a5/manifest", R"({"bunny":"13851a76"})"}}));
}

}  // namespace
}  // namespace tessera
