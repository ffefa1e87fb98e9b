#include "client/output/picture_encoder.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

// The values of a picture file in memory, three for each pixel.
template <typename Value>
std::vector<Value> DecodeAs(const std::string& bytes, const std::string& name, OIIO::TypeDesc type) {
  OIIO::Filesystem::IOMemReader memory(const_cast<char*>(bytes.data()), bytes.size());
  const auto input = OIIO::ImageInput::open(name, nullptr, &memory);
  EXPECT_TRUE(input) << name << OIIO::geterror();
  if (!input) return {};
  EXPECT_EQ(input->spec().nchannels, 3) << name;
  std::vector<Value> values(static_cast<size_t>(input->spec().width * input->spec().height * 3));
  EXPECT_TRUE(input->read_image(0, 0, 0, 3, type, values.data())) << name;
  return values;
}

std::vector<uint8_t> Decode(const std::string& bytes) {
  return DecodeAs<uint8_t>(bytes, "picture.png", OIIO::TypeDesc::UINT8);
}

std::string Png(const LoadedPicture& picture) {
  const auto png = EncodeAs(PictureFormat::kPng, picture, "x.png");
  EXPECT_TRUE(png) << png.error().message;
  return png ? *png : std::string();
}

TEST(Png, ShowsTheDataWindowInItsPlaceInTheDisplayWindow) {
  LoadedPicture picture;
  picture.width = 3;
  picture.height = 2;
  picture.bounds = {1, 1, 3, 2};
  picture.channels = {"B", "G", "R"};
  picture.values = {0, 0, 0.5f, 0.25f, 0.5f, 0};  // red, then a bluish green
  const std::vector<uint8_t> pixels = Decode(Png(picture));
  ASSERT_EQ(pixels.size(), 18u);
  for (size_t i = 0; i < 12; ++i) EXPECT_EQ(pixels[i], 0);  // the first row and the first pixel of the second
  EXPECT_EQ(pixels[12], 188);                               // 0.5 in sRGB
  EXPECT_EQ(pixels[13], 0);
  EXPECT_EQ(pixels[16], 188);
  EXPECT_EQ(pixels[17], 137);  // 0.25 in sRGB
}

TEST(Png, HighlightsAndBadValuesStayInRangeAndKeepTheirOrder) {
  LoadedPicture picture;
  picture.width = 5;
  picture.height = 1;
  picture.bounds = {0, 0, 5, 1};
  picture.channels = {"Y"};
  picture.values = {0.9f, 2.0f, 50.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()};
  const std::vector<uint8_t> pixels = Decode(Png(picture));
  EXPECT_LT(pixels[0], pixels[3]);
  EXPECT_LT(pixels[3], pixels[6]);
  EXPECT_EQ(pixels[9], 0);
  EXPECT_EQ(pixels[12], 0);
}

// 2x2 pixels: red, green, bright, black.
LoadedPicture Colors() {
  LoadedPicture picture;
  picture.width = picture.height = 2;
  picture.bounds = {0, 0, 2, 2};
  picture.channels = {"R", "G", "B", "Z"};
  picture.values = {0.5f, 0, 0, 9, 0, 0.25f, 0, 9, 8, 4, 2, 9, 0, 0, 0, 9};
  return picture;
}

TEST(LinearFormats, KeepTheValuesOfTheColours) {
  const std::pair<PictureFormat, const char*> formats[] = {
      {PictureFormat::kTiff, "p.tif"}, {PictureFormat::kPfm, "p.pfm"}, {PictureFormat::kRadiance, "p.hdr"}};
  for (const auto& [format, name] : formats) {
    const auto bytes = EncodeAs(format, Colors(), name);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const std::vector<float> values = DecodeAs<float>(*bytes, name, OIIO::TypeDesc::FLOAT);
    const std::vector<float> expected = {0.5f, 0, 0, 0, 0.25f, 0, 8, 4, 2, 0, 0, 0};
    ASSERT_EQ(values.size(), expected.size()) << name;
    for (size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], expected[i], expected[i] / 100) << name;
  }
}

TEST(LinearFormats, HoldNoValueThatTheyCannot) {
  LoadedPicture picture = Colors();
  picture.values[0] = -1;
  picture.values[1] = std::numeric_limits<float>::quiet_NaN();
  picture.values[2] = std::numeric_limits<float>::infinity();
  const auto bytes = EncodeAs(PictureFormat::kRadiance, picture, "p.hdr");
  ASSERT_TRUE(bytes) << bytes.error().message;
  const std::vector<float> values = DecodeAs<float>(*bytes, "p.hdr", OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(values[0], 0);
  EXPECT_EQ(values[1], 0);
  EXPECT_GT(values[2], 1e38f);
}

TEST(Jpeg, LooksLikeThePng) {
  LoadedPicture picture;
  picture.width = picture.height = 16;
  picture.bounds = {0, 0, 16, 16};
  picture.channels = {"B", "G", "R"};
  for (int i = 0; i < 256; ++i) picture.values.insert(picture.values.end(), {0.1f, 0.3f, 0.6f});
  const auto bytes = EncodeAs(PictureFormat::kJpeg, picture, "p.jpg");
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_EQ(bytes->substr(0, 2), "\xff\xd8");
  const std::vector<uint8_t> jpeg = DecodeAs<uint8_t>(*bytes, "p.jpg", OIIO::TypeDesc::UINT8);
  const std::vector<uint8_t> png = Decode(Png(picture));
  ASSERT_EQ(jpeg.size(), png.size());
  for (size_t i = 0; i < png.size(); ++i) EXPECT_NEAR(jpeg[i], png[i], 4);
}

}  // namespace
}  // namespace tessera
