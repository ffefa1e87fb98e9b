#include "client/live/picture_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

namespace tessera {
namespace {

using Rgb = std::array<uint8_t, 3>;

constexpr const char* kUpperHalf = "\xe2\x96\x80";  // U+2580
constexpr std::string_view kShadesFromDark = " .:-=+*#%@";

// The levels of the cube of 6 x 6 x 6 colours of terminals with 256 colours, which follows 16 others; 24
// greys follow it.
constexpr int kCubeLevels[] = {0, 95, 135, 175, 215, 255};
constexpr int kCubeStart = 16, kGreyStart = 232, kGreys = 24;
constexpr int kGreySpan = 16;  // between the channels of colours that are shown as greys

// A 4 x 4 Bayer matrix.
constexpr int kBayer[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};

// What is added to a fraction before it is rounded down, so that its mean is right over some pixels.
double DitherThreshold(int x, int y) {
  return (kBayer[y % 4][x % 4] + 0.5) / 16;
}

int SquaredDistance(const Rgb& color, const std::array<int, 3>& other) {
  int sum = 0;
  for (size_t c = 0; c < 3; ++c) sum += (color[c] - other[c]) * (color[c] - other[c]);
  return sum;
}

int NearestOf256(const Rgb& color) {
  std::array<int, 3> level{}, cube{};
  for (size_t c = 0; c < 3; ++c) {
    const auto nearest = std::ranges::min_element(
        kCubeLevels, {}, [&](int each) { return std::abs(each - static_cast<int>(color[c])); });
    level[c] = static_cast<int>(nearest - std::begin(kCubeLevels));
    cube[c] = *nearest;
  }
  const int mean = (color[0] + color[1] + color[2]) / 3;
  const int grey = std::clamp((mean - 3) / 10, 0, kGreys - 1), value = 8 + 10 * grey;
  if (SquaredDistance(color, {value, value, value}) < SquaredDistance(color, cube)) return kGreyStart + grey;
  return kCubeStart + 36 * level[0] + 6 * level[1] + level[2];
}

// The levels of the cube are far apart, so colours are mixed of neighbouring pixels.
int DitheredOf256(const Rgb& color, int x, int y) {
  const auto [low, high] = std::ranges::minmax(color);
  if (high - low < kGreySpan) return NearestOf256(color);
  int index = 0;
  for (const uint8_t value : color) {
    int level = 0;
    while (level + 2 < static_cast<int>(std::size(kCubeLevels)) && kCubeLevels[level + 1] <= value) ++level;
    const double share =
        static_cast<double>(value - kCubeLevels[level]) / (kCubeLevels[level + 1] - kCubeLevels[level]);
    index = index * 6 + level + static_cast<int>(share + DitherThreshold(x, y));
  }
  return kCubeStart + index;
}

// Selects a colour for what is above (38) or below (48) in the cells that follow.
std::string ColorText(int plane, const SmallPicture& picture, int x, int y, Graphics kind) {
  const Rgb color = y < picture.height ? picture.At(x, y) : Rgb{};
  if (kind == Graphics::kColors256) return fmt::format("\x1b[{};5;{}m", plane, DitheredOf256(color, x, y));
  return fmt::format("\x1b[{};2;{};{};{}m", plane, color[0], color[1], color[2]);
}

std::string ShadesLine(const SmallPicture& picture, int y) {
  std::string line;
  for (int x = 0; x < picture.width; ++x) {
    const Rgb color = picture.At(x, y);
    const double grey = (0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]) / 256;
    line += kShadesFromDark[static_cast<size_t>(grey * static_cast<double>(kShadesFromDark.size()))];
  }
  return line;
}

std::string HalvesLine(const SmallPicture& picture, int y, Graphics kind) {
  std::string line, above_now, below_now;
  for (int x = 0; x < picture.width; ++x) {
    std::string above_text = ColorText(38, picture, x, y, kind);
    std::string below_text = ColorText(48, picture, x, y + 1, kind);
    if (above_text != above_now) line += above_now = std::move(above_text);
    if (below_text != below_now) line += below_now = std::move(below_text);
    line += kUpperHalf;
  }
  return line + "\x1b[0m";
}

constexpr int kSixelLevels = 6;
constexpr int kBandRows = 6;  // of pixels in one character of sixels

// The colour of the cube that stands for the pixel at this place.
int DitheredColor(const Rgb& color, int x, int y) {
  int index = 0;
  for (const uint8_t value : color) {
    const double exact = value * (kSixelLevels - 1) / 255.0;
    const int level = std::min(static_cast<int>(exact + DitherThreshold(x, y)), kSixelLevels - 1);
    index = index * kSixelLevels + level;
  }
  return index;
}

void AppendRun(std::string& text, char sixel, int count) {
  if (count > 3) {
    text += fmt::format("!{}{}", count, sixel);
  } else {
    text.append(static_cast<size_t>(count), sixel);
  }
}

// The sixels of one colour in a band; `bits` has a number for each column.
std::string SixelRow(const std::vector<uint8_t>& bits) {
  std::string text;
  for (size_t begin = 0; begin < bits.size();) {
    size_t end = begin;
    while (end < bits.size() && bits[end] == bits[begin]) ++end;
    if (end == bits.size() && bits[begin] == 0) break;
    AppendRun(text, static_cast<char>('?' + bits[begin]), static_cast<int>(end - begin));
    begin = end;
  }
  return text;
}

std::string Base64(const std::vector<uint8_t>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(bytes.size() - i, 3);
    uint32_t bits = 0;
    for (size_t b = 0; b < 3; ++b) bits = bits << 8 | (b < count ? bytes[i + b] : 0u);
    for (size_t d = 0; d < 4; ++d) text += d <= count ? kDigits[bits >> (18 - 6 * d) & 63] : '=';
  }
  return text;
}

constexpr int kKittyImage = 4711;        // any number that other programs hardly use
constexpr size_t kKittyChunkMax = 4096;  // bytes, by the protocol

}  // namespace

std::vector<std::string> CellLines(const SmallPicture& picture, Graphics kind) {
  std::vector<std::string> lines;
  if (kind == Graphics::kShades) {
    for (int y = 0; y < picture.height; ++y) lines.push_back(ShadesLine(picture, y));
  } else {
    for (int y = 0; y < picture.height; y += 2) lines.push_back(HalvesLine(picture, y, kind));
  }
  return lines;
}

std::string SixelText(const SmallPicture& picture) {
  std::string text = fmt::format("\x1bP0;1q\"1;1;{};{}", picture.width, picture.height);
  for (int i = 0; i < kSixelLevels * kSixelLevels * kSixelLevels; ++i) {
    constexpr int kPercent = 100 / (kSixelLevels - 1);
    text += fmt::format("#{};2;{};{};{}", i, i / 36 * kPercent, i / 6 % 6 * kPercent, i % 6 * kPercent);
  }
  for (int top = 0; top < picture.height; top += kBandRows) {
    std::map<int, std::vector<uint8_t>> band;  // by colour
    for (int y = top; y < std::min(top + kBandRows, picture.height); ++y) {
      for (int x = 0; x < picture.width; ++x) {
        auto& bits = band[DitheredColor(picture.At(x, y), x, y)];
        bits.resize(static_cast<size_t>(picture.width));
        bits[static_cast<size_t>(x)] |= static_cast<uint8_t>(1 << (y - top));
      }
    }
    for (const auto& [color, bits] : band) text += fmt::format("#{}{}$", color, SixelRow(bits));
    text += '-';
  }
  return text + "\x1b\\";
}

std::string KittyText(const SmallPicture& picture, int columns, int rows) {
  const std::string data = Base64(picture.rgb);
  std::string text;
  for (size_t at = 0; at < data.size(); at += kKittyChunkMax) {
    const std::string keys = at > 0 ? ""
                                    : fmt::format("a=T,f=24,s={},v={},i={},p=1,c={},r={},C=1,", picture.width,
                                                  picture.height, kKittyImage, columns, rows);
    text += fmt::format("\x1b_G{}q=2,m={};{}\x1b\\", keys, at + kKittyChunkMax < data.size() ? 1 : 0,
                        std::string_view(data).substr(at, kKittyChunkMax));
  }
  return text;
}

std::string KittyRemoval() {
  return fmt::format("\x1b_Ga=d,d=I,i={},q=2\x1b\\", kKittyImage);
}

}  // namespace tessera
