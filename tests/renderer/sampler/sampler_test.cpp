#include "renderer/sampler/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/renderer/sampler/net.h"

namespace tessera {
namespace {

constexpr Randomization kRandomization = Randomization::kFastOwen;

struct NamedSampler {
  std::string name;
  Sampler sampler;
};

// All kinds, for a picture of 32 x 32 pixels with `samples` samples each, a square number and a power of two.
std::vector<NamedSampler> Samplers(uint64_t seed = 0, uint32_t samples = 64) {
  const auto side = static_cast<uint32_t>(std::sqrt(static_cast<float>(samples)));
  return {{"independent", IndependentSampler(seed)},
          {"stratified", StratifiedSampler(seed, side, side, true)},
          {"sobol", SobolSampler(seed, kRandomization)},
          {"paddedsobol", PaddedSobolSampler(seed, kRandomization)},
          {"zsobol", ZSobolSampler(seed, kRandomization, std::bit_width(samples) - 1, 32, 32)},
          {"halton", HaltonSampler(seed, Randomization::kPermuteDigits, 32, 32)},
          {"pmj02bn", Pmj02bnSampler(seed)}};
}

TEST(Sampler, TheTestsCoverEveryKind) {
  EXPECT_EQ(Samplers().size(), std::variant_size_v<AnySampler>);
}

// The first 12 numbers of a sample.
std::vector<float> Draw(Sampler& sampler, int x, int y, uint32_t index) {
  sampler.StartSample(x, y, index);
  std::vector<float> values;
  for (int i = 0; i < 4; ++i) {
    values.push_back(sampler.Get1D());
    const Point2 p = sampler.Get2D();
    values.insert(values.end(), {p.x, p.y});
  }
  return values;
}

TEST(Sampler, AnySampleCanBeDrawnInAnyOrder) {
  for (const auto& [name, sampler] : Samplers()) {
    Sampler forward = sampler, backward = sampler;
    std::vector<std::vector<float>> first;
    for (uint32_t i = 0; i < 64; ++i) first.push_back(Draw(forward, 5, 7, i));
    for (int i = 63; i >= 0; --i) {
      Draw(backward, 1, 2, static_cast<uint32_t>(i));  // another sample must not change the next
      EXPECT_EQ(Draw(backward, 5, 7, static_cast<uint32_t>(i)), first[i]) << name;
    }
  }
}

// What a sampler keeps between the samples of a pixel must not show, in any dimension.
TEST(Sampler, AUsedSamplerDrawsWhatANewOneDraws) {
  constexpr int kDimensions = 150;
  for (const auto& [name, sampler] : Samplers()) {
    Sampler used = sampler;
    for (const int x : {5, 6, 5}) {
      for (uint32_t i = 0; i < 5; ++i) {
        Sampler fresh = sampler;
        fresh.StartSample(x, 7, i);
        used.StartSample(x, 7, i);
        for (int dimension = 0; dimension < kDimensions; ++dimension) {
          // Samples of a pixel may use a dimension alone or as the first or second of a pair.
          if ((dimension + i) % 3 == 0) {
            const Point2 a = fresh.Get2D(), b = used.Get2D();
            ASSERT_TRUE(a.x == b.x && a.y == b.y) << name << " " << dimension;
          } else {
            ASSERT_EQ(fresh.Get1D(), used.Get1D()) << name << " " << dimension;
          }
        }
      }
    }
  }
}

TEST(Sampler, ValuesLieInTheUnitInterval) {
  for (auto& [name, sampler] : Samplers()) {
    for (int pixel = 0; pixel < 50; ++pixel) {
      for (uint32_t i = 0; i < 64; ++i) {
        for (float v : Draw(sampler, pixel % 32, pixel / 32, i)) {
          EXPECT_GE(v, 0.0f) << name;
          EXPECT_LT(v, 1.0f) << name;
        }
      }
    }
  }
}

TEST(Sampler, EveryDimensionHasMeanOneHalfAndVarianceOneTwelfth) {
  for (auto& [name, sampler] : Samplers()) {
    std::vector<double> sum(12), squares(12);
    constexpr int kPixels = 400, kSamples = 64;
    for (int pixel = 0; pixel < kPixels; ++pixel) {
      for (uint32_t i = 0; i < kSamples; ++i) {
        const std::vector<float> values = Draw(sampler, pixel % 20, pixel / 20, i);
        for (int d = 0; d < 12; ++d) {
          sum[d] += values[d];
          squares[d] += values[d] * values[d];
        }
      }
    }
    constexpr double kCount = kPixels * kSamples;
    for (int d = 0; d < 12; ++d) {
      const double mean = sum[d] / kCount;
      EXPECT_NEAR(mean, 0.5, 5 / std::sqrt(12 * kCount)) << name << " dimension " << d;
      EXPECT_NEAR(squares[d] / kCount - mean * mean, 1.0 / 12, 0.002);
    }
  }
}

TEST(Sampler, DifferentPixelsAndSeedsGetDifferentNumbers) {
  std::vector<NamedSampler> samplers = Samplers(0), others = Samplers(1);
  for (size_t i = 0; i < samplers.size(); ++i) {
    auto& [name, a] = samplers[i];
    Sampler& b = others[i].sampler;
    EXPECT_NE(Draw(a, 3, 4, 0), Draw(a, 4, 3, 0)) << name;
    EXPECT_NE(Draw(a, 3, 4, 0), Draw(b, 3, 4, 0)) << name;
  }
}

// Cells of columns x rows that the points fall into.
size_t CellsFilled(const std::vector<Point2>& points, int columns, int rows) {
  // Points on the border of a cell, rounded to a float, belong to the one above.
  constexpr double kRounding = 4e-6;
  std::set<int> cells;
  for (const Point2 p : points) {
    cells.insert(static_cast<int>(static_cast<double>(p.x) * columns + kRounding) * rows +
                 static_cast<int>(static_cast<double>(p.y) * rows + kRounding));
  }
  return cells.size();
}

TEST(HaltonSampler, SamplesOfAPixelFillTheBoxesOfItsBases) {
  for (const Randomization randomization :
       {Randomization::kNone, Randomization::kPermuteDigits, Randomization::kOwen}) {
    for (const auto& [width, height] : {std::pair{32, 32}, std::pair{1000, 700}, std::pair{1, 1}}) {
      HaltonSampler sampler(0, randomization, width, height);
      std::vector<Point2> first, second;
      for (uint32_t i = 0; i < 35 * 36; ++i) {
        sampler.StartSample(width / 2, height / 3, i);
        first.push_back(sampler.Get2D());
        second.push_back(sampler.Get2D());
      }
      const auto prefix = [](const std::vector<Point2>& points, int count) {
        return std::vector<Point2>(points.begin(), points.begin() + count);
      };
      // Bases 2 and 3, then 5 and 7.
      EXPECT_EQ(CellsFilled(prefix(first, 6), 2, 3), 6u);
      EXPECT_EQ(CellsFilled(prefix(first, 36), 4, 9), 36u);
      EXPECT_EQ(CellsFilled(prefix(second, 35), 5, 7), 35u);
      EXPECT_EQ(CellsFilled(second, 25, 49), 25u * 49);
    }
  }
}

TEST(HaltonSampler, TheFirstTwoDimensionsAreOneSequenceOverAllPixels) {
  // With the pixel before the point, the points of 32 x 81 pixels are the Halton sequence.
  constexpr int kWidth = 32, kHeight = 81;
  HaltonSampler sampler(0, Randomization::kNone, kWidth, kHeight);
  std::set<std::pair<float, float>> points, expected;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (uint32_t i = 0; i < 4; ++i) {
        sampler.StartSample(x, y, i);
        const Point2 p = sampler.Get2D();
        points.emplace((static_cast<float>(x) + p.x) / kWidth, (static_cast<float>(y) + p.y) / kHeight);
      }
    }
  }
  const auto& bases = HaltonBases();
  for (uint64_t i = 0; i < 4 * kWidth * kHeight; ++i) {
    expected.emplace(RadicalInverse(bases[0], i), RadicalInverse(bases[1], i));
  }
  ASSERT_EQ(points.size(), expected.size());
  for (auto a = points.begin(), b = expected.begin(); a != points.end(); ++a, ++b) {
    EXPECT_NEAR(a->first, b->first, 1e-6f);
    EXPECT_NEAR(a->second, b->second, 1e-6f);
  }
}

TEST(Pmj02bnSampler, PointsAreNetsMovedByBlueNoise) {
  Pmj02bnSampler sampler(0);
  for (const auto& [x, y] : {std::pair{0, 0}, std::pair{17, 40}, std::pair{200, 9}}) {
    for (uint32_t count : {4u, 16u, 256u}) {
      std::vector<Point2> first, second;
      const auto unmoved = [&](Point2 p, int dimension) {
        // The whole multiple of 2^-12 by which points were moved comes off exactly.
        const auto back = [&](float u, int d) {
          const double v = static_cast<double>(u) - static_cast<double>(sampler.Shift(d));
          return static_cast<float>(v < 0 ? v + 1 : v);
        };
        return Point2{back(p.x, dimension), back(p.y, dimension + 1)};
      };
      for (uint32_t i = 0; i < count; ++i) {
        sampler.StartSample(x, y, i);
        first.push_back(unmoved(sampler.Get2D(), 0));
        sampler.Get1D();
        second.push_back(unmoved(sampler.Get2D(), 3));
      }
      ExpectNet(first);
      ExpectNet(second);
    }
  }
}

// The variance of the mean over blocks of 4 x 4 pixels of an estimate with `samples` samples per pixel.
double VarianceOfBlocks(Sampler sampler, uint32_t samples) {
  constexpr int kSide = 64, kBlock = 4, kBlocks = kSide / kBlock;
  double sum = 0, squares = 0;
  for (int block = 0; block < kBlocks * kBlocks; ++block) {
    double mean = 0;
    for (int pixel = 0; pixel < kBlock * kBlock; ++pixel) {
      for (uint32_t i = 0; i < samples; ++i) {
        sampler.StartSample(block % kBlocks * kBlock + pixel % kBlock,
                            block / kBlocks * kBlock + pixel / kBlock, i);
        sampler.Get2D();
        const float u = sampler.Get1D();
        const Point2 p = sampler.Get2D();
        mean += (u * p.x + (p.y < 0.3f ? 1.0f : 0.0f)) / (kBlock * kBlock * static_cast<float>(samples));
      }
    }
    sum += mean;
    squares += mean * mean;
  }
  constexpr double kCount = kBlocks * kBlocks;
  return squares / kCount - sum / kCount * (sum / kCount);
}

TEST(Pmj02bnSampler, ErrorsOfNeighbouringPixelsCancel) {
  EXPECT_LT(VarianceOfBlocks(Pmj02bnSampler(0), 1), 0.5 * VarianceOfBlocks(IndependentSampler(0), 1));
  EXPECT_LT(VarianceOfBlocks(Pmj02bnSampler(0), 4),
            0.7 * VarianceOfBlocks(PaddedSobolSampler(0, kRandomization), 4));
}

TEST(BlueNoise, EveryValueOccursOnceAndBlocksHaveTheSameMean) {
  const BlueNoise& noise = BlueNoise::Get();
  std::set<float> values;
  double squares = 0;
  constexpr int kBlock = 4, kBlocks = kBlueNoiseSide / kBlock;
  for (int block = 0; block < kBlocks * kBlocks; ++block) {
    double mean = 0;
    for (int pixel = 0; pixel < kBlock * kBlock; ++pixel) {
      const float value =
          noise.At(block % kBlocks * kBlock + pixel % kBlock, block / kBlocks * kBlock + pixel / kBlock);
      values.insert(value);
      mean += value / (kBlock * kBlock);
    }
    squares += (mean - 0.5) * (mean - 0.5);
  }
  EXPECT_EQ(values.size(), static_cast<size_t>(kBlueNoiseSide * kBlueNoiseSide));
  EXPECT_GE(*values.begin(), 0);
  EXPECT_LT(*values.rbegin(), 1);
  // White noise: 1/12 over the number of pixels of a block.
  EXPECT_LT(squares / (kBlocks * kBlocks), 0.2 / 12 / (kBlock * kBlock));
  EXPECT_EQ(noise.At(3, 5), noise.At(3 + kBlueNoiseSide, 5 + 2 * kBlueNoiseSide));
}

TEST(Sampler, StratifiedSamplesFillEveryStratumOnce) {
  StratifiedSampler sampler(0, 8, 8, true);
  std::set<int> strata, line;
  for (uint32_t i = 0; i < 64; ++i) {
    sampler.StartSample(1, 1, i);
    const Point2 p = sampler.Get2D();
    strata.insert(static_cast<int>(p.x * 8) * 8 + static_cast<int>(p.y * 8));
    line.insert(static_cast<int>(sampler.Get1D() * 64));
  }
  EXPECT_EQ(strata.size(), 64u);
  EXPECT_EQ(line.size(), 64u);
}

}  // namespace
}  // namespace tessera
