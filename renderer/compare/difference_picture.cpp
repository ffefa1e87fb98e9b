#include "renderer/compare/difference_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderer/compare/legend_font.h"

namespace tessera {
namespace {

constexpr float kRampColors[][3] = {{0, 0, 4},      {28, 16, 68},    {79, 18, 123},
                                    {129, 37, 129}, {181, 54, 122},  {229, 80, 100},
                                    {251, 135, 97}, {254, 194, 135}, {252, 253, 191}};
constexpr int kMargin = 4, kBarHeight = 8, kLineHeight = kGlyphHeight + 3;
constexpr int kLegendHeight = kMargin + kBarHeight + 3 + 2 * kLineHeight + 1;
constexpr int kWidthMin = 160;  // so that the texts of the legend fit
constexpr uint8_t kText = 220, kBackground = 32;

void SetRampColor(float fraction, uint8_t* rgb) {
  constexpr int kLast = static_cast<int>(std::size(kRampColors)) - 1;
  const float place = std::clamp(fraction, 0.0f, 1.0f) * kLast;
  const int index = std::min(static_cast<int>(place), kLast - 1);
  for (int c = 0; c < 3; ++c) {
    const float value =
        std::lerp(kRampColors[index][c], kRampColors[index + 1][c], place - static_cast<float>(index));
    rgb[c] = static_cast<uint8_t>(std::lround(value));
  }
}

uint8_t* PixelOf(BytePicture& picture, int x, int y) {
  return &picture.values[static_cast<size_t>((int64_t{y} * picture.width + x) * 3)];
}

int TextWidth(const std::string& text) {
  return static_cast<int>(text.size()) * (kGlyphWidth + 1) - 1;
}

// (x, y) is the upper left corner. Letters without a glyph are blank, and what is beyond the border is cut.
void DrawText(BytePicture& picture, int x, int y, const std::string& text) {
  for (size_t i = 0; i < text.size(); ++i) {
    const auto* const glyph = std::ranges::find(kGlyphs, text[i], &Glyph::letter);
    if (glyph == std::end(kGlyphs)) continue;
    const int left = x + static_cast<int>(i) * (kGlyphWidth + 1);
    for (int row = 0; row < kGlyphHeight; ++row) {
      for (int column = 0; column < kGlyphWidth; ++column) {
        const bool is_set = (glyph->rows[row] >> (kGlyphWidth - 1 - column) & 1) != 0;
        if (is_set && left + column < picture.width)
          std::fill_n(PixelOf(picture, left + column, y + row), 3, kText);
      }
    }
  }
}

std::string Upper(std::string text) {
  std::ranges::replace(text, 'e', 'E');
  return text;
}

void DrawLegend(BytePicture& picture, int top, const ErrorMap& map) {
  const int bar_width = picture.width - 2 * kMargin;
  for (int x = 0; x < bar_width; ++x) {
    const float fraction = static_cast<float>(x) / static_cast<float>(std::max(bar_width - 1, 1));
    for (int y = 0; y < kBarHeight; ++y)
      SetRampColor(fraction, PixelOf(picture, kMargin + x, top + kMargin + y));
  }
  const int line = top + kMargin + kBarHeight + 3;
  const std::string middle = Upper(fmt::format("{:.3g}", 0.5f * map.top));
  const std::string last = Upper(fmt::format("{:.3g}", map.top));
  DrawText(picture, kMargin, line, "0");
  DrawText(picture, (picture.width - TextWidth(middle)) / 2, line, middle);
  DrawText(picture, picture.width - kMargin - TextWidth(last), line, last);
  DrawText(picture, kMargin, line + kLineHeight, map.title);
}

}  // namespace

std::vector<float> LargestDifferences(const LoadedPicture& a, const LoadedPicture& b) {
  const size_t pixels = static_cast<size_t>(a.bounds.area());
  std::vector<float> largest(pixels, 0);
  for (size_t ca = 0; ca < a.channels.size(); ++ca) {
    const auto found = std::ranges::find(b.channels, a.channels[ca]);
    if (found == b.channels.end()) continue;
    const size_t cb = static_cast<size_t>(found - b.channels.begin());
    for (size_t i = 0; i < pixels; ++i) {
      const float x = a.values[i * a.channels.size() + ca], y = b.values[i * b.channels.size() + cb];
      float difference = x == y || (std::isnan(x) && std::isnan(y)) ? 0 : std::abs(x - y);
      if (std::isnan(difference)) difference = std::numeric_limits<float>::infinity();
      largest[i] = std::max(largest[i], difference);
    }
  }
  return largest;
}

float TopOf(std::vector<float> errors) {
  if (errors.empty()) return 1;
  const size_t place = (errors.size() * 99 + 99) / 100 - 1;
  std::ranges::nth_element(errors, errors.begin() + static_cast<ptrdiff_t>(place));
  const float top = errors[place];
  return top > 0 && std::isfinite(top) ? top : 1;
}

BytePicture DrawErrors(const ErrorMap& map) {
  const int height = map.width == 0 ? 0 : static_cast<int>(map.errors.size()) / map.width;
  BytePicture picture{std::max(map.width, kWidthMin), height + kLegendHeight, {}};
  picture.values.assign(static_cast<size_t>(int64_t{picture.width} * picture.height * 3), kBackground);
  for (int y = 0; y < height; ++y) {
    const auto row =
        map.errors.subspan(static_cast<size_t>(int64_t{y} * map.width), static_cast<size_t>(map.width));
    for (int x = 0; x < map.width; ++x)
      SetRampColor(row[static_cast<size_t>(x)] / map.top, PixelOf(picture, x, y));
  }
  DrawLegend(picture, height, map);
  return picture;
}

}  // namespace tessera
