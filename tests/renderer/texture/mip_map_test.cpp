#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "renderer/texture/mip_map.h"

namespace tessera {
namespace {

constexpr std::array<ImageFilter, 4> kFilters{ImageFilter::kPoint, ImageFilter::kBilinear,
                                              ImageFilter::kTrilinear, ImageFilter::kEwa};
constexpr std::array<WrapMode, 4> kWraps{WrapMode::kRepeat, WrapMode::kBlack, WrapMode::kClamp,
                                         WrapMode::kOctahedralSphere};

Image FloatImage(int width, int height, int channels, const std::vector<float>& values) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = channels;
  image.format = PixelFormat::kFloat;
  image.channel_names =
      channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  image.bytes.resize(values.size() * sizeof(float));
  if (!values.empty()) std::memcpy(image.bytes.data(), values.data(), image.bytes.size());
  return image;
}

Image ByteImage(int width, int height, int channels, const std::vector<uint8_t>& values) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = channels;
  image.format = PixelFormat::kUint8;
  image.encoding = {ColorEncoding::Kind::kSrgb, 1};
  image.bytes = values;
  return image;
}

std::vector<float> RandomValues(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> values(count);
  for (float& v : values) v = static_cast<float>(random() % 1000) / 999.0f;
  return values;
}

// Bilinear interpolation of a level, written out, of a repeating image.
float BilinearOf(const MipMap& map, int level, Point2 st) {
  const int w = std::max(1, map.width() >> level), h = std::max(1, map.height() >> level);
  const float x = st.x * w - 0.5f, y = st.y * h - 0.5f;
  const int xi = static_cast<int>(std::floor(x)), yi = static_cast<int>(std::floor(y));
  const auto texel = [&](int i, int j) { return map.Texel(level, (i + 8 * w) % w, (j + 8 * h) % h, 0); };
  const float dx = x - xi, dy = y - yi;
  return (1 - dy) * ((1 - dx) * texel(xi, yi) + dx * texel(xi + 1, yi)) +
         dy * ((1 - dx) * texel(xi, yi + 1) + dx * texel(xi + 1, yi + 1));
}

TEST(MipMap, ConstantImageGivesItsConstantForEveryFilterAndFootprint) {
  const Image pictures[] = {FloatImage(8, 4, 1, std::vector<float>(32, 0.3f)),
                            FloatImage(5, 7, 1, std::vector<float>(35, 0.3f)),
                            ByteImage(6, 6, 1, std::vector<uint8_t>(36, 100))};
  for (const Image& picture : pictures) {
    const float expected = picture.Get(0, 0, 0);
    for (const WrapMode wrap : {WrapMode::kRepeat, WrapMode::kClamp, WrapMode::kOctahedralSphere}) {
      const MipMap map = MipMap::Grey(picture, 0, wrap);
      for (const ImageFilter filter : kFilters) {
        for (const float width : {0.0f, 0.01f, 0.1f, 0.4f, 3.0f}) {
          for (const Point2 st : {Point2{0.31f, 0.72f}, Point2{0, 0}, Point2{1, 1}, Point2{-0.2f, 1.7f}}) {
            EXPECT_NEAR(map.LookUpGrey(st, {width, 0}, {0, width / 3}, {filter, 8}), expected, 1e-6f);
          }
        }
      }
    }
  }
}

TEST(MipMap, EachLevelIsTheMeanOfFourTexelsOfTheOneBelow) {
  const MipMap map = MipMap::Grey(FloatImage(16, 4, 1, RandomValues(64, 1)), 0, WrapMode::kRepeat);
  ASSERT_EQ(map.levels(), 5);
  for (int level = 1; level < map.levels(); ++level) {
    for (int y = 0; y < std::max(1, 4 >> level); ++y) {
      for (int x = 0; x < 16 >> level; ++x) {
        const int below = level < 3 ? 2 * y + 1 : 0;  // one row high from level 2 on
        const float mean =
            (map.Texel(level - 1, 2 * x, level < 3 ? 2 * y : 0, 0) +
             map.Texel(level - 1, 2 * x + 1, level < 3 ? 2 * y : 0, 0) +
             map.Texel(level - 1, 2 * x, below, 0) + map.Texel(level - 1, 2 * x + 1, below, 0)) /
            4;
        EXPECT_NEAR(map.Texel(level, x, y, 0), mean, 1e-6f) << level << " " << x << " " << y;
      }
    }
  }
}

TEST(MipMap, ResamplingToPowersOfTwoKeepsTheMean) {
  std::vector<float> ramp;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 24; ++x) ramp.push_back(static_cast<float>(x) + 0.5f);
  }
  const MipMap map = MipMap::Grey(FloatImage(24, 12, 1, ramp), 0, WrapMode::kClamp);
  EXPECT_EQ(map.width(), 32);
  EXPECT_EQ(map.height(), 16);
  for (int x = 2; x < 30; ++x) EXPECT_NEAR(map.Texel(0, x, 5, 0), (x + 0.5f) * 24 / 32, 0.06f) << x;
  EXPECT_NEAR(map.Texel(map.levels() - 1, 0, 0, 0), 12, 0.1f);
}

TEST(MipMap, EightBitImagesKeepTheirValues) {
  std::vector<uint8_t> values(256);
  for (int i = 0; i < 256; ++i) values[i] = static_cast<uint8_t>(i);
  const Image picture = ByteImage(16, 16, 1, values);
  const MipMap map = MipMap::Grey(picture, 0, WrapMode::kRepeat);
  for (int i = 0; i < 256; ++i)
    EXPECT_EQ(map.Texel(0, i % 16, i / 16, 0), picture.Get(i % 16, i / 16, 0)) << i;
  EXPECT_LE(map.bytes(), 256u * 4 / 3 + 32);
}

TEST(MipMap, TrilinearLookupsBlendTheTwoLevelsNextToTheFootprint) {
  const int size = 32;
  const MipMap map =
      MipMap::Grey(FloatImage(size, size, 1, RandomValues(size * size, 2)), 0, WrapMode::kRepeat);
  const int top = map.levels() - 1;
  const ImageFilterSettings trilinear{ImageFilter::kTrilinear, 8};
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    const Point2 st{static_cast<float>(random() % 1000) / 1000, static_cast<float>(random() % 1000) / 1000};
    const float level = 1 + static_cast<float>(random() % 1000) / 1000 * (top - 1.01f);
    // Of the footprint: two texels of that level's next finer one.
    const float width = std::exp2(level - top);
    const int fine = static_cast<int>(level);
    const float t = level - fine;
    const float expected = (1 - t) * BilinearOf(map, fine, st) + t * BilinearOf(map, fine + 1, st);
    EXPECT_NEAR(map.LookUpGrey(st, {width / 2, 0}, {0, width / 3}, trilinear), expected, 2e-4f) << level;
    EXPECT_NEAR(map.LookUpGrey(st, {0, width / 3}, {-width / 2, 0}, {ImageFilter::kBilinear, 8}),
                BilinearOf(map, fine, st), 2e-4f);
  }
}

TEST(MipMap, SmallFootprintsUseTheFinestLevelAndWideOnesTheMean) {
  const int size = 16;
  const MipMap map =
      MipMap::Grey(FloatImage(size, size, 1, RandomValues(size * size, 4)), 0, WrapMode::kRepeat);
  const Point2 st{0.37f, 0.81f};
  for (const ImageFilter filter : kFilters) {
    const float mean = map.Texel(map.levels() - 1, 0, 0, 0);
    EXPECT_NEAR(map.LookUpGrey(st, {2, 0}, {0, 2}, {filter, 8}), mean, 1e-6f);
    if (filter == ImageFilter::kPoint) {
      EXPECT_EQ(map.LookUpGrey(st, {}, {}, {filter, 8}), map.Texel(0, 5, 12, 0));
    } else {
      EXPECT_NEAR(map.LookUpGrey(st, {}, {}, {filter, 8}), BilinearOf(map, 0, st), 1e-5f);
    }
  }
}

TEST(MipMap, TheEllipticalFilterKeepsStripesThatLieAlongItsFootprint) {
  const int size = 64;
  std::vector<float> stripes;  // vertical ones, four texels wide
  for (int i = 0; i < size * size; ++i) stripes.push_back(i % size / 4 % 2 == 0 ? 1.0f : 0.0f);
  const MipMap map = MipMap::Grey(FloatImage(size, size, 1, stripes), 0, WrapMode::kRepeat);
  const Point2 on_stripe{2.0f / size, 0.5f};
  const Vec2 along{0, 16.0f / size}, across{1.0f / size, 0};
  EXPECT_GT(map.LookUpGrey(on_stripe, along, across, {ImageFilter::kEwa, 16}), 0.9f);
  EXPECT_NEAR(map.LookUpGrey(on_stripe, along, across, {ImageFilter::kTrilinear, 8}), 0.5f, 0.1f);
  // Limited to round footprints it blurs as much.
  EXPECT_NEAR(map.LookUpGrey(on_stripe, along, across, {ImageFilter::kEwa, 1}), 0.5f, 0.1f);
  // Turned by 90 degrees it covers many stripes.
  EXPECT_NEAR(map.LookUpGrey(on_stripe, {16.0f / size, 0}, {0, 1.0f / size}, {ImageFilter::kEwa, 16}), 0.5f,
              0.1f);
}

TEST(MipMap, EveryWrapModeExtendsTheImageAsNamed) {
  const std::vector<float> values{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  const auto at = [&](WrapMode wrap, int x, int y) {
    const MipMap map = MipMap::Grey(FloatImage(4, 4, 1, values), 0, wrap);
    return map.LookUpGrey({(x + 0.5f) / 4, (y + 0.5f) / 4}, {}, {}, {ImageFilter::kPoint, 8});
  };
  for (const WrapMode wrap : kWraps) EXPECT_EQ(at(wrap, 2, 1), 7);
  EXPECT_EQ(at(WrapMode::kRepeat, -1, 0), 4);
  EXPECT_EQ(at(WrapMode::kRepeat, 9, -6), 10);
  EXPECT_EQ(at(WrapMode::kBlack, -1, 0), 0);
  EXPECT_EQ(at(WrapMode::kBlack, 0, 4), 0);
  EXPECT_EQ(at(WrapMode::kClamp, -3, 1), 5);
  EXPECT_EQ(at(WrapMode::kClamp, 7, 9), 16);
  // Over the right edge the octahedral square continues on the same edge, upside down.
  EXPECT_EQ(at(WrapMode::kOctahedralSphere, 4, 0), 16);
  EXPECT_EQ(at(WrapMode::kOctahedralSphere, 1, 4), 15);
}

TEST(MipMap, BlackBordersFadeIn) {
  const MipMap map = MipMap::Grey(FloatImage(4, 4, 1, std::vector<float>(16, 1)), 0, WrapMode::kBlack);
  EXPECT_NEAR(map.LookUpGrey({0, 0.5f}, {}, {}, {ImageFilter::kBilinear, 8}), 0.5f, 1e-6f);
  EXPECT_NEAR(map.LookUpGrey({0, 0}, {}, {}, {ImageFilter::kBilinear, 8}), 0.25f, 1e-6f);
}

TEST(MipMap, ColorsKeepTheirChannelsInEveryFormat) {
  const Image bytes = ByteImage(2, 1, 4, {255, 0, 128, 9, 255, 0, 128, 9});
  Image halves = FloatImage(1, 1, 3, {});
  halves.format = PixelFormat::kHalf;
  halves.bytes = {0x00, 0x3c, 0x00, 0x00, 0x00, 0x38};  // 1, 0, 0.5
  const Image floats = FloatImage(1, 1, 3, {1, 0, 0.25f});
  const auto blue = [](const Image& image, std::array<int, 3> channels) {
    const MipMap map = MipMap::Color(image, channels, WrapMode::kRepeat);
    const Float4 rgb = map.LookUpColor({0.3f, 0.4f}, {}, {}, {ImageFilter::kBilinear, 8});
    EXPECT_NEAR(rgb[0], 1, 1e-6f);
    EXPECT_NEAR(rgb[1], 0, 1e-6f);
    return rgb[2];
  };
  EXPECT_NEAR(blue(bytes, {0, 1, 2}), bytes.Get(0, 0, 2), 1e-6f);
  EXPECT_EQ(blue(halves, {0, 1, 2}), 0.5f);
  EXPECT_EQ(blue(floats, {0, 1, 2}), 0.25f);
}

TEST(MipMap, ResultIsFiniteForAnyImageAndAnyLookup) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float kNan = std::nanf("");
  const MipMap map =
      MipMap::Grey(FloatImage(2, 2, 1, {kInfinity, kNan, -kInfinity, 1}), 0, WrapMode::kRepeat);
  const std::vector<float> odd{0, 1e-30f, 1e30f, -1e30f, kInfinity, -kInfinity, kNan};
  for (const ImageFilter filter : kFilters) {
    for (const float a : odd) {
      for (const float b : odd) {
        for (const float c : odd) {
          EXPECT_TRUE(std::isfinite(map.LookUpGrey({a, b}, {b, c}, {c, a}, {filter, 8})))
              << a << " " << b << " " << c;
        }
      }
    }
  }
}

}  // namespace
}  // namespace tessera
