#include "client/png_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

// The pixels of a PNG in memory, three values each.
std::vector<uint8_t> Decode(const std::string& bytes) {
  OIIO::Filesystem::IOMemReader memory(const_cast<char*>(bytes.data()), bytes.size());
  const auto input = OIIO::ImageInput::open("picture.png", nullptr, &memory);
  EXPECT_TRUE(input);
  std::vector<uint8_t> pixels(
      static_cast<size_t>(input->spec().width * input->spec().height * input->spec().nchannels));
  EXPECT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, pixels.data()));
  return pixels;
}

TEST(Png, ShowsTheDataWindowInItsPlaceInTheDisplayWindow) {
  LoadedPicture picture;
  picture.width = 3;
  picture.height = 2;
  picture.bounds = {1, 1, 3, 2};
  picture.channels = {"B", "G", "R"};
  picture.values = {0, 0, 0.5f, 0.25f, 0.5f, 0};  // red, then a bluish green
  const auto png = EncodePng(picture, "x.png");
  ASSERT_TRUE(png) << png.error().message;
  const std::vector<uint8_t> pixels = Decode(*png);
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
  const std::vector<uint8_t> pixels = Decode(*EncodePng(picture, "x.png"));
  EXPECT_LT(pixels[0], pixels[3]);
  EXPECT_LT(pixels[3], pixels[6]);
  EXPECT_EQ(pixels[9], 0);
  EXPECT_EQ(pixels[12], 0);
}

}  // namespace
}  // namespace tessera
