#include "client/live/picture_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/client/live/live_pictures.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHalf = "\xe2\x96\x80";

TEST(SmallPicture, FitsKeepsItsProportionsAndGrowsOnlyIfItMay) {
  EXPECT_EQ(FittedSize(1920, 1080, 80, 46, true), (std::array{80, 45}));
  EXPECT_EQ(FittedSize(100, 400, 80, 46, true), (std::array{12, 46}));
  EXPECT_EQ(FittedSize(10, 5, 80, 46, true), (std::array{80, 40}));
  EXPECT_EQ(FittedSize(10, 5, 80, 46, false), (std::array{10, 5}));
  EXPECT_EQ(FittedSize(60000, 1, 80, 46, false), (std::array{80, 1}));
}

TEST(SmallPicture, HasTheMeanOfThePixelsThatEachStandsFor) {
  LoadedPicture picture = PictureOf(4, 2, 0);
  picture.values = {0, 0, 0, 0.5f, 0, 0, 1, 1, 1, 1, 1, 1,  //
                    0, 0, 0, 0.5f, 0, 0, 1, 1, 1, 1, 1, 1};
  const SmallPicture small = Shrink(picture, 2, 1);
  EXPECT_EQ(small.At(0, 0)[0], 137) << "0.25 in sRGB";
  EXPECT_EQ(small.At(0, 0)[1], 0);
  EXPECT_GT(small.At(1, 0)[2], 225) << "white, tone-mapped";
  EXPECT_EQ(Shrink(picture, 8, 4).rgb.size(), 8u * 4 * 3);
}

// Red, green, blue and white above; the second row black.
SmallPicture Colors() {
  return {4, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
}

TEST(CellLines, ShowTwoPixelsInEachCell) {
  const std::string half = kHalf;
  EXPECT_THAT(CellLines(Colors(), Graphics::kTrueColor),
              ElementsAre("\x1b[38;2;255;0;0m\x1b[48;2;0;0;0m" + half + "\x1b[38;2;0;255;0m" + half +
                          "\x1b[38;2;0;0;255m" + half + "\x1b[38;2;255;255;255m" + half + "\x1b[0m"));
  EXPECT_THAT(CellLines(Colors(), Graphics::kColors256),
              ElementsAre("\x1b[38;5;196m\x1b[48;5;16m" + half + "\x1b[38;5;46m" + half + "\x1b[38;5;21m" +
                          half + "\x1b[38;5;231m" + half + "\x1b[0m"));
  EXPECT_THAT(CellLines({1, 1, {128, 128, 128}}, Graphics::kColors256),
              ElementsAre("\x1b[38;5;244m\x1b[48;5;16m" + half + "\x1b[0m"))
      << "a grey of the 24, and a picture of an odd number of rows";
}

// Of the cube of 256 colours: black, and the darkest red.
TEST(CellLines, MixColoursThatTheTerminalLacksOfThoseThatItHas) {
  SmallPicture dark{4, 4, {}};
  for (int i = 0; i < 16; ++i) dark.rgb.insert(dark.rgb.end(), {48, 0, 0});
  std::string text;
  for (const std::string& line : CellLines(dark, Graphics::kColors256)) text += line;
  EXPECT_THAT(text, HasSubstr(";5;16m"));
  EXPECT_THAT(text, HasSubstr(";5;52m"));
  for (const char* other : {";5;17m", ";5;53m", ";5;88m", ";5;233m"})
    EXPECT_EQ(text.find(other), std::string::npos) << other;
}

TEST(CellLines, HaveNoControlSequencesWithoutColours) {
  EXPECT_THAT(CellLines(Colors(), Graphics::kShades), ElementsAre(":# @", "    "));
}

// Draws sixels as a terminal does. Returns the index of the colour of each pixel, or -1.
std::vector<int> DrawnSixels(const std::string& text, int width, int height) {
  std::vector<int> pixels(static_cast<size_t>(width * height), -1);
  size_t at = text.find('q') + 1;
  int x = 0, top = 0, color = 0;
  const auto number = [&] {
    char* end = nullptr;
    const long value = std::strtol(&text[at], &end, 10);
    at = static_cast<size_t>(end - text.data());
    return static_cast<int>(value);
  };
  while (text[at] != '\x1b') {
    const char c = text[at++];
    int count = 1;
    if (c == '"' || c == '#') {
      const int first = number();
      int members = 1;
      for (; text[at] == ';'; ++members) {
        ++at;
        number();
      }
      if (c == '#' && members == 1) color = first;
      continue;
    }
    if (c == '$') x = 0;
    if (c == '-') {
      x = 0;
      top += 6;
    }
    if (c == '$' || c == '-') continue;
    char sixel = c;
    if (c == '!') {
      count = number();
      sixel = text[at++];
    }
    for (; count > 0; --count, ++x) {
      for (int bit = 0; bit < 6; ++bit) {
        if (((sixel - '?') >> bit & 1) == 0) continue;
        EXPECT_TRUE(x < width && top + bit < height);
        if (x >= width || top + bit >= height) return pixels;
        pixels[static_cast<size_t>((top + bit) * width + x)] = color;
      }
    }
  }
  return pixels;
}

TEST(SixelText, DrawsEveryPixelInItsColour) {
  SmallPicture picture{20, 13, {}};
  for (int i = 0; i < 20 * 13; ++i) {
    const auto level = [&](int divisor) { return static_cast<uint8_t>(i / divisor % 6 * 51); };
    for (const int divisor : {36, 6, 1}) picture.rgb.push_back(level(divisor));
  }
  const std::string text = SixelText(picture);
  EXPECT_TRUE(text.starts_with("\x1bP0;1q\"1;1;20;13#0;2;0;0;0#1;2;0;0;20#"));
  EXPECT_TRUE(text.ends_with("\x1b\\"));
  const std::vector<int> drawn = DrawnSixels(text, 20, 13);
  for (int i = 0; i < 20 * 13; ++i) EXPECT_EQ(drawn[static_cast<size_t>(i)], i % 216) << i;
}

TEST(SixelText, MixesColoursThatThePaletteLacks) {
  SmallPicture picture{64, 64, std::vector<uint8_t>(64 * 64 * 3, 100)};
  int sum = 0;
  for (const int color : DrawnSixels(SixelText(picture), 64, 64)) sum += color % 6 * 51;
  EXPECT_NEAR(static_cast<double>(sum) / (64 * 64), 100, 2);
}

TEST(KittyText, SendsThePixelsInChunks) {
  const SmallPicture picture = Shrink(PictureOf(50, 40, 0), 50, 40);
  const std::string text = KittyText(picture, 5, 2);
  EXPECT_TRUE(text.starts_with("\x1b_Ga=T,f=24,s=50,v=40,i=4711,p=1,c=5,r=2,C=1,q=2,m=1;"));
  std::string data;
  size_t chunks = 0;
  for (size_t at = 0; at < text.size(); ++chunks) {
    const size_t begin = text.find(';', at) + 1, end = text.find("\x1b\\", begin);
    EXPECT_LE(end - begin, 4096u);
    EXPECT_EQ(text[begin - 2], end + 2 == text.size() ? '0' : '1');
    data += text.substr(begin, end - begin);
    at = end + 2;
  }
  EXPECT_EQ(chunks, 2u);
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uint8_t> bytes;
  uint32_t bits = 0;
  for (size_t i = 0; i < data.size(); ++i) {
    bits = bits << 6 | static_cast<uint32_t>(digits.find(data[i]));
    if (i % 4 != 3) continue;
    for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<uint8_t>(bits >> shift));
    bits = 0;
  }
  EXPECT_EQ(bytes, picture.rgb);
}

}  // namespace
}  // namespace tessera
