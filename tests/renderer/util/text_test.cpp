#include "renderer/util/text.h"

#include <gtest/gtest.h>

#include <array>

namespace tessera {
namespace {

constexpr std::array<std::string_view, 5> kWords{"sphere", "disk", "cylinder", "trianglemesh", "plymesh"};

TEST(Text, NearestWordForgivesTypingMistakes) {
  EXPECT_EQ(NearestWord("sphere", kWords), "sphere");
  EXPECT_EQ(NearestWord("spere", kWords), "sphere");
  EXPECT_EQ(NearestWord("SPHERE", kWords), "sphere");
  EXPECT_EQ(NearestWord("dsik", kWords), "disk");
  EXPECT_EQ(NearestWord("trianglmesh", kWords), "trianglemesh");
}

TEST(Text, WordsThatResembleNoneHaveNoNearest) {
  EXPECT_EQ(NearestWord("torus", kWords), "");
  EXPECT_EQ(NearestWord("", kWords), "");
  EXPECT_EQ(NearestWord(std::string(1000, 's'), kWords), "");
  EXPECT_EQ(NearestWord("sphere", {}), "");
}

TEST(Text, SuggestionsAreQuestionsOrNothing) {
  EXPECT_EQ(DidYouMean("spheer", kWords), " (did you mean \"sphere\"?)");
  EXPECT_EQ(DidYouMean("xyzzy", kWords), "");
}

TEST(Text, FormerWordsAreAnsweredWithThoseOfToday) {
  constexpr std::array<std::string_view, 4> kMaterials{"conductor", "dielectric", "coateddiffuse", "glas"};
  EXPECT_EQ(DidYouMean("glass", kMaterials), " (pbrt-v4 calls it \"dielectric\")");
  EXPECT_EQ(DidYouMean("plastic", kMaterials), " (pbrt-v4 calls it \"coateddiffuse\")");
  constexpr std::array<std::string_view, 2> kTypes{"float", "spectrum"}, kValues{"rgb", "spectrum"};
  EXPECT_EQ(DidYouMean("color", kTypes), " (pbrt-v4 calls it \"spectrum\")");
  EXPECT_EQ(DidYouMean("color", kValues), " (pbrt-v4 calls it \"rgb\")");
  // Only where the word of today is one of those that are expected.
  EXPECT_EQ(DidYouMean("matte", kWords), "");
}

}  // namespace
}  // namespace tessera
