#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "renderer/texture/noise.h"
#include "renderer/texture/patterns.h"

namespace tessera {
namespace {

TEST(Checkerboard, NarrowFootprintsShowTheSquaresUnfiltered) {
  for (const Point2 st :
       {Point2{0.5f, 0.5f}, Point2{1.5f, 1.5f}, Point2{-0.5f, -0.5f}, Point2{2.5f, -1.5f}}) {
    const int parity = static_cast<int>(std::floor(st.x) + std::floor(st.y) + 100) % 2;
    EXPECT_EQ(CheckerboardWeight(TextureCoordinates2{st, {}, {}}), static_cast<float>(parity))
        << st.x << " " << st.y;
  }
  EXPECT_EQ(CheckerboardWeight(TextureCoordinates2{{3.5f, 0.5f}, {}, {}}), 1);
  EXPECT_EQ(CheckerboardWeight(TextureCoordinates3{{0.5f, 0.5f, 0.5f}, {}, {}}), 0);
  EXPECT_EQ(CheckerboardWeight(TextureCoordinates3{{0.5f, 1.5f, 0.5f}, {}, {}}), 1);
  EXPECT_EQ(CheckerboardWeight(TextureCoordinates3{{-0.5f, 1.5f, -0.5f}, {}, {}}), 1);
}

TEST(Checkerboard, WideFootprintsShowHalfOfEachColor) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const float s = static_cast<float>(random() % 1000) / 100, t = static_cast<float>(random() % 1000) / 100;
    EXPECT_NEAR(CheckerboardWeight(TextureCoordinates2{{s, t}, {20, 0}, {0, 20}}), 0.5f, 1e-3f);
    EXPECT_NEAR(CheckerboardWeight(TextureCoordinates3{{s, t, s}, {20, 0, 0}, {0, 20, 20}}), 0.5f, 1e-3f);
  }
}

// Integrates the tent of half width 1.5 times the footprint's over the squares.
float IntegratedWeight(Point2 st, float ds, float dt) {
  constexpr int kSteps = 400;
  double sum = 0, weight_sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double x = (i + 0.5) / kSteps * 2 - 1, y = (j + 0.5) / kSteps * 2 - 1;
      const double weight = (1 - std::abs(x)) * (1 - std::abs(y));
      const double cell = std::floor(st.x + x * 1.5 * ds) + std::floor(st.y + y * 1.5 * dt);
      sum += weight * (static_cast<long>(cell) & 1);
      weight_sum += weight;
    }
  }
  return static_cast<float>(sum / weight_sum);
}

TEST(Checkerboard, TheFilteredWeightIsTheIntegralUnderATent) {
  std::mt19937 random(2);
  for (int i = 0; i < 20; ++i) {
    const Point2 st{static_cast<float>(random() % 400) / 100 - 2,
                    static_cast<float>(random() % 400) / 100 - 2};
    const float ds = 0.05f + static_cast<float>(random() % 100) / 100, dt = 0.3f;
    EXPECT_NEAR(CheckerboardWeight(TextureCoordinates2{st, {ds, -dt / 2}, {-ds / 3, dt}}),
                IntegratedWeight(st, ds, dt), 4e-3f);
  }
}

TEST(Checkerboard, FootprintsThatAreNotFiniteGiveAFiniteWeight) {
  EXPECT_EQ(CheckerboardWeight(TextureCoordinates3{{1, 2, 3}, {INFINITY, 0, 0}, {}}), 0.5f);
  EXPECT_EQ(CheckerboardWeight(TextureCoordinates3{{NAN, 2, 3}, {}, {}}), 0.5f);
  EXPECT_EQ(CheckerboardWeight(TextureCoordinates2{{1, 2}, {1e30f, 0}, {}}), 0.5f);
}

TEST(Noise, AgreesWithPerlinsReferenceImplementation) {
  // From an implementation of the 2002 article in another language.
  EXPECT_FLOAT_EQ(Noise({0.5f, 0.5f, 0.5f}), -0.125f);
  EXPECT_NEAR(Noise({1.25f, 2.5f, 3.75f}), -0.03836346f, 1e-6f);
  EXPECT_NEAR(Noise({-7.3f, 100.1f, 0.9f}), 0.0976562f, 1e-5f);
  EXPECT_NEAR(Noise({255.5f, 0.25f, -0.5f}), -0.29736328f, 1e-6f);
}

TEST(Noise, IsZeroAtIntegerPointsAndWithinMinusOneAndOne) {
  std::mt19937 random(4);
  const auto draw = [&random] { return static_cast<float>(random() % 100000) / 1000 - 50; };
  float least = 0, most = 0;
  for (int i = 0; i < 20000; ++i) {
    const float x = draw(), y = draw(), z = draw();
    EXPECT_EQ(Noise({std::floor(x), std::floor(y), std::floor(z)}), 0);
    const float v = Noise({x, y, z});
    least = std::min(least, v);
    most = std::max(most, v);
  }
  EXPECT_GT(least, -1.05f);
  EXPECT_LT(least, -0.6f);
  EXPECT_LT(most, 1.05f);
  EXPECT_GT(most, 0.6f);
  EXPECT_TRUE(std::isfinite(Noise({1e30f, -1e30f, NAN})));
}

TEST(Noise, OctavesFinerThanTheFootprintFadeOut) {
  const Point3 p{1.3f, 2.6f, 0.7f};
  EXPECT_EQ(FractalNoise(p, {4, 0, 0}, {0, 4, 0}, 0.5f, 8), 0);
  EXPECT_NE(FractalNoise(p, {0.01f, 0, 0}, {0, 0.01f, 0}, 0.5f, 8), 0);
  EXPECT_FLOAT_EQ(FractalNoise(p, {}, {}, 0.5f, 1), Noise(p) + 0);
  // What has faded from the turbulence still counts with its mean: 0.2 (1 + 1/2 + 1/4 + ...), and once more
  // for the octave that is about to appear.
  EXPECT_NEAR(Turbulence(p, {4, 0, 0}, {0, 4, 0}, 0.5f, 8), 0.2f + 0.2f * (2 - 1.0f / 128), 1e-5f);
  for (int i = 0; i < 100; ++i) EXPECT_GE(Turbulence(p * (0.37f * i), {0.1f, 0, 0}, {}, 0.5f, 6), 0);
}

TEST(Dots, CoverTheExpectedFractionOfTheSurface) {
  constexpr int kCells = 100;
  int with_dot = 0, inside = 0;
  for (int i = 0; i < kCells * kCells; ++i) {
    with_dot += Noise({i % kCells + 0.5f, i / kCells + 0.5f, 0.5f}) > 0;
  }
  EXPECT_GT(with_dot, kCells * kCells / 3);
  std::mt19937 random(5);
  constexpr int kPoints = 100000;
  for (int i = 0; i < kPoints; ++i) {
    const float s = static_cast<float>(random() % 100000) / 1000,
                t = static_cast<float>(random() % 100000) / 1000;
    inside += InsideDot({s - 0.5f, t - 0.5f});
  }
  const double share = static_cast<double>(with_dot) / (kCells * kCells);
  EXPECT_NEAR(static_cast<double>(inside) / kPoints, share * 3.14159265 * 0.35 * 0.35, 0.005);
}

TEST(Marble, IsAnAlbedo) {
  for (int i = 0; i < 1000; ++i) {
    const float v = 0.173f * static_cast<float>(i);
    const Vec3 rgb = MarbleColor({{v, 2 * v, -v}, {0.01f, 0, 0}, {0, 0.01f, 0}}, {8, 0.5f, 1, 0.2f});
    for (int c = 0; c < 3; ++c) {
      EXPECT_GT(rgb[c], 0.2f);
      EXPECT_LE(rgb[c], 0.91f);
    }
  }
}

}  // namespace
}  // namespace tessera
