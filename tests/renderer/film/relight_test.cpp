#include "renderer/film/relight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace tessera {
namespace {

using testing::HasSubstr;

// Two pixels; channel number c of pixel p has the value 10 p + c.
LoadedPicture LitPicture() {
  LoadedPicture picture;
  picture.width = picture.bounds.x1 = 2;
  picture.height = picture.bounds.y1 = 1;
  picture.channels = {
      "B",           "G",           "R",           "depth.Z",     "direct.R",    "direct_diffuse.R",
      "light_key.B", "light_key.G", "light_key.R", "light_sky.B", "light_sky.G", "light_sky.R",
      "samples"};
  for (size_t p = 0; p < 2; ++p) {
    for (size_t c = 0; c < picture.channels.size(); ++c)
      picture.values.push_back(static_cast<float>(10 * p + c));
  }
  picture.attributes["tessera:seed"] = "7";
  return picture;
}

float ValueOf(const LoadedPicture& picture, size_t pixel, const std::string& channel) {
  const auto found = std::ranges::find(picture.channels, channel);
  EXPECT_NE(found, picture.channels.end()) << channel;
  return picture
      .values[pixel * picture.channels.size() + static_cast<size_t>(found - picture.channels.begin())];
}

TEST(Relight, SumsTheGroupsTimesTheirGains) {
  const LightGain gains[] = {{"key", {2, 3, 0}}, {"key", {1, 1, 5}}};
  const auto mixed = Relight(LitPicture(), gains);
  ASSERT_TRUE(mixed);
  for (size_t p = 0; p < 2; ++p) {
    const auto base = static_cast<float>(10 * p);
    EXPECT_EQ(ValueOf(*mixed, p, "R"), (base + 8) * 2 + base + 11);
    EXPECT_EQ(ValueOf(*mixed, p, "G"), (base + 7) * 3 + base + 10);
    EXPECT_EQ(ValueOf(*mixed, p, "B"), base + 9) << "gains of a group are multiplied";
    EXPECT_EQ(ValueOf(*mixed, p, "light_key.R"), (base + 8) * 2) << "so that it can be mixed again";
    EXPECT_EQ(ValueOf(*mixed, p, "depth.Z"), base + 3);
    EXPECT_EQ(ValueOf(*mixed, p, "samples"), base + 12);
  }
  EXPECT_EQ(std::ranges::count(mixed->channels, "direct.R") +
                std::ranges::count(mixed->channels, "direct_diffuse.R"),
            0)
      << "layers that no longer fit are left out";
}

TEST(Relight, IsWrittenAndReadAgain) {
  const auto mixed = Relight(LitPicture(), {});
  const auto bytes = EncodeExr(*mixed, ExrFormat());
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto read = DecodeExr(*bytes, "mixed.exr");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->channels, mixed->channels);
  EXPECT_EQ(read->values, mixed->values);
  EXPECT_EQ(read->attributes.at("tessera:seed"), "7");
}

TEST(Relight, PicturesOfOtherProgramsKeepWhatCanBeWritten) {
  LoadedPicture picture = LitPicture();
  picture.channels[3] = "W";  // the name of our own weight
  picture.types.assign(picture.channels.size(), ExrType::kFloat);
  picture.types[3] = ExrType::kHalf;
  picture.attributes["owner"] = "somebody";
  auto mixed = Relight(picture, {});
  ASSERT_TRUE(mixed);
  SetLightTypes(*mixed, ExrType::kHalf);
  const auto bytes = EncodeExr(*mixed, ExrFormat());
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto read = DecodeExr(*bytes, "mixed.exr");
  ASSERT_TRUE(read);
  EXPECT_EQ(ValueOf(*read, 1, "W"), 13);
  EXPECT_EQ(read->attributes.at("owner"), "somebody");
  for (size_t c = 0; c < read->channels.size(); ++c) {
    const bool is_half = read->channels[c] != "samples";
    EXPECT_EQ(read->types[c], is_half ? ExrType::kHalf : ExrType::kFloat) << read->channels[c];
  }
}

TEST(Relight, NamesGroupsThatThePictureLacks) {
  const LightGain gains[] = {{"kay", {2, 2, 2}}};
  const auto refused = Relight(LitPicture(), gains);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              HasSubstr("no light group \"kay\" (did you mean \"key\"?); it has key, sky"));
  LoadedPicture plain = LitPicture();
  plain.channels = {"B", "G", "R"};
  plain.values.resize(6);
  EXPECT_THAT(Relight(plain, {}).error().message, HasSubstr("has no light groups"));
  LoadedPicture torn = LitPicture();
  torn.channels[6] = "light_key.A";
  EXPECT_THAT(Relight(torn, {}).error().message, HasSubstr("no channel \"light_key.B\""));
  LoadedPicture blind = LitPicture();
  blind.channels[1] = "Y";
  EXPECT_THAT(Relight(blind, {}).error().message, HasSubstr("no channel G"));
}

}  // namespace
}  // namespace tessera
