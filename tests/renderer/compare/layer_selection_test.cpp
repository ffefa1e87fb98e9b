#include "renderer/compare/layer_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

LoadedPicture TwoPixels() {
  LoadedPicture picture;
  picture.width = 2;
  picture.height = 1;
  picture.bounds = {0, 0, 2, 1};
  picture.channels = {"A", "B", "Z", "albedo.R", "key.albedo.R"};
  picture.values = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  return picture;
}

TEST(Layers, AreTheNamesBeforeTheLastDot) {
  EXPECT_THAT(LayersOf(TwoPixels().channels), ElementsAre("RGB", "Z", "albedo", "key.albedo"));
}

TEST(Layers, AreSelectedWithTheirValues) {
  const auto colors = SelectLayer(TwoPixels(), "RGB", "p.exr");
  ASSERT_TRUE(colors);
  EXPECT_THAT(colors->channels, ElementsAre("A", "B"));
  EXPECT_THAT(colors->values, ElementsAre(1, 2, 6, 7));
  const auto albedo = SelectLayer(TwoPixels(), "albedo", "p.exr");
  ASSERT_TRUE(albedo);
  EXPECT_THAT(albedo->channels, ElementsAre("R"));
  EXPECT_THAT(albedo->values, ElementsAre(4, 9));
  EXPECT_EQ(albedo->bounds, TwoPixels().bounds);
}

TEST(Layers, ThatArePrefixesOfOthersOrMissingAreRefusedWithAList) {
  for (const char* name : {"key", "albedo.R", "", "rgb"}) {
    const auto layer = SelectLayer(TwoPixels(), name, "p.exr");
    ASSERT_FALSE(layer) << name;
    EXPECT_EQ(layer.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(layer.error().message, HasSubstr("it has RGB, Z, albedo, key.albedo"));
  }
}

}  // namespace
}  // namespace tessera
