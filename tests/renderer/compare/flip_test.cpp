#include "renderer/compare/flip.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace tessera {
namespace {

using Color = std::array<float, 3>;
using Painter = std::function<Color(int x, int y)>;

LoadedPicture Painted(int width, int height, const Painter& color) {
  LoadedPicture picture;
  picture.width = width;
  picture.height = height;
  picture.bounds = {0, 0, width, height};
  picture.channels = {"B", "G", "R"};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Color rgb = color(x, y);
      picture.values.insert(picture.values.end(), {rgb[2], rgb[1], rgb[0]});
    }
  }
  return picture;
}

LoadedPicture Uniform(const Color& color) {
  return Painted(30, 26, [&](int, int) { return color; });
}

// A pattern of many colours, frequencies and edges.
Color Pattern(int x, int y, int k) {
  return {static_cast<float>((x * 7 + y * 3 + k * 5) % 11) / 10,
          static_cast<float>((x * 2 + y * 5 + k) % 7) / 6, static_cast<float>((x + y * (3 + k)) % 5) / 4};
}

FlipErrors Ldr(const LoadedPicture& test, const LoadedPicture& reference) {
  return LdrFlip(test, reference, 2, {}).value();
}
FlipErrors Hdr(const LoadedPicture& test, const LoadedPicture& reference) {
  return HdrFlip(test, reference, 2, {}).value();
}
float At(const FlipErrors& errors, int x, int y) {
  return errors.errors[static_cast<size_t>(y * errors.width + x)];
}

constexpr double kTolerance = 2e-4;  // of single precision

// The expected values of these tests are those of an implementation in double precision with filters of two
// dimensions, written from the paper alone.
TEST(LdrFlip, GivesUniformColorsTheErrorsOfThePaper) {
  const struct {
    Color a, b;
    double error;
  } cases[] = {
      {{1, 1, 1}, {0, 0, 0}, 0.96737976},  // the paper: 0.97
      {{0, 1, 0}, {0, 0, 1}, 1},           // the colours that differ most
      {{0.5f, 0.5f, 0.5f}, {0.25f, 0.25f, 0.25f}, 0.45184962},
      {{1, 0, 0}, {0, 1, 0}, 0.98666228},
      {{0.2f, 0.3f, 0.4f}, {0.25f, 0.3f, 0.35f}, 0.17222108},
  };
  for (const auto& pair : cases) {
    EXPECT_NEAR(Ldr(Uniform(pair.a), Uniform(pair.b)).mean, pair.error, kTolerance);
    EXPECT_NEAR(Ldr(Uniform(pair.b), Uniform(pair.a)).mean, pair.error, kTolerance);
  }
}

TEST(LdrFlip, AgreesWithAnIndependentImplementationOnPatternsEdgesAndDots) {
  const auto pattern = [](int k) { return Painted(30, 26, [k](int x, int y) { return Pattern(x, y, k); }); };
  const FlipErrors patterns = Ldr(pattern(0), pattern(1));
  EXPECT_NEAR(patterns.mean, 0.31958688, kTolerance);
  EXPECT_NEAR(At(patterns, 0, 0), 0.58166262, kTolerance);
  EXPECT_NEAR(At(patterns, 7, 13), 0.13812075, kTolerance);
  EXPECT_NEAR(At(patterns, 29, 25), 0.50130438, kTolerance);
  const LoadedPicture grey = Uniform({0.5f, 0.5f, 0.5f});
  const FlipErrors dot = Ldr(Painted(30, 26,
                                     [](int x, int y) {
                                       const float value = x == 15 && y == 13 ? 1.0f : 0.5f;
                                       return Color{value, value, value};
                                     }),
                             grey);
  EXPECT_NEAR(dot.mean, 0.00285033, kTolerance);
  EXPECT_NEAR(At(dot, 15, 13), 0.21096320, kTolerance);
  EXPECT_NEAR(At(dot, 12, 13), 0.01452230, kTolerance);
  const FlipErrors edge = Ldr(Painted(30, 26,
                                      [](int x, int) {
                                        const float value = x < 15 ? 0.5f : 0.6f;
                                        return Color{value, value, value};
                                      }),
                              grey);
  EXPECT_NEAR(edge.mean, 0.12200050, kTolerance);
  EXPECT_NEAR(At(edge, 15, 13), 0.25291200, kTolerance);
  EXPECT_NEAR(At(edge, 14, 13), 0.16854913, kTolerance);
  EXPECT_NEAR(At(edge, 29, 13), 0.19621471, kTolerance);
}

LoadedPicture BrightPattern(int width, int height, int k) {
  return Painted(width, height, [k](int x, int y) {
    const float gain = 1 + static_cast<float>(x * x * y) / 500;
    const Color color = Pattern(x, y, k);
    return Color{color[0] * gain, color[1] * gain, color[2] * gain};
  });
}

TEST(HdrFlip, AgreesWithAnIndependentImplementation) {
  const FlipErrors errors = Hdr(BrightPattern(30, 26, 0), BrightPattern(30, 26, 1));
  EXPECT_NEAR(errors.mean, 0.33662435, kTolerance);
  EXPECT_NEAR(At(errors, 0, 0), 0.55786024, kTolerance);
  EXPECT_NEAR(At(errors, 7, 13), 0.11658144, kTolerance);
  EXPECT_NEAR(At(errors, 29, 25), 0.50226268, kTolerance);
  EXPECT_NEAR(errors.exposures.start, -3.86096249, 1e-5);
  EXPECT_NEAR(errors.exposures.stop, 0.31130861, 1e-5);
  EXPECT_EQ(errors.exposures.count, 5);
}

TEST(HdrFlip, IsZeroForEqualPicturesAndDoesNotDependOnTheirBrightness) {
  const LoadedPicture a = BrightPattern(30, 26, 0), b = BrightPattern(30, 26, 1);
  EXPECT_EQ(Hdr(a, a).mean, 0);
  LoadedPicture a_bright = a, b_bright = b;
  for (float& value : a_bright.values) value *= 1024;
  for (float& value : b_bright.values) value *= 1024;
  EXPECT_NEAR(Hdr(a_bright, b_bright).mean, Hdr(a, b).mean, kTolerance);
}

TEST(HdrFlip, IsTheSameForAnyNumberOfThreadsAndAcrossTiles) {
  const LoadedPicture a = BrightPattern(290, 75, 0), b = BrightPattern(290, 75, 1);
  const FlipErrors one = HdrFlip(a, b, 1, {}).value(), four = HdrFlip(a, b, 4, {}).value();
  EXPECT_EQ(one.errors, four.errors);
  EXPECT_EQ(one.mean, four.mean);
  // The same pixels beside a border of tiles and in the middle of one.
  const auto shifted = [](int k) {
    return Painted(290, 75, [k](int x, int y) { return Pattern(x - 40, y + 20, k); });
  };
  const auto plain = [](int k) { return Painted(290, 75, [k](int x, int y) { return Pattern(x, y, k); }); };
  const FlipErrors moved = Ldr(shifted(0), shifted(1)), still = Ldr(plain(0), plain(1));
  for (int y = 32; y < 64; ++y) {
    for (int x = 100; x < 240; ++x) EXPECT_EQ(At(moved, x + 40, y - 20), At(still, x, y)) << x << " " << y;
  }
}

TEST(HdrFlip, TakesInfinitiesNotANumbersAndPicturesOfOnePixel) {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::nanf("");
  const LoadedPicture black = Uniform({0, 0, 0});
  EXPECT_EQ(Hdr(Uniform({nan, -1, 0}), black).mean, 0);
  EXPECT_NEAR(Hdr(Uniform({infinity, infinity, infinity}), black).mean, 0.9674, 1e-3);
  EXPECT_NEAR(Hdr(black, Uniform({infinity, infinity, infinity})).mean, 0.9674, 1e-3);
  const auto dot = [](float value) {
    return Painted(1, 1, [&](int, int) { return Color{value, value, value}; });
  };
  EXPECT_EQ(Hdr(dot(2), dot(2)).mean, 0);
  EXPECT_GT(Hdr(dot(1e30f), dot(1e-30f)).mean, 0.1);
}

TEST(HdrFlip, StopsWhenAskedTo) {
  std::stop_source stop;
  stop.request_stop();
  const auto errors = HdrFlip(Uniform({1, 1, 1}), Uniform({0, 1, 1}), 2, stop.get_token());
  ASSERT_FALSE(errors);
  EXPECT_EQ(errors.error().kind, ErrorKind::kInterrupted);
}

}  // namespace
}  // namespace tessera
