#include "renderer/film/adaptive.h"

#include <algorithm>
#include <array>

#include "renderer/film/radiance_tile.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr double kTileShare = 0.25;  // of the tile's mean in what a pixel is judged by

double Mean(double sum, double weight) {
  return weight != 0 ? sum / weight : 0;
}

// Row 16 of Pascal's triangle from its middle on: the weights of pixels by their distance. Their standard
// deviation is 2 pixels.
constexpr std::array<double, 9> kWeights{12870, 11440, 8008, 4368, 1820, 560, 120, 16, 1};

// Sums of `values` around every place of rows of `length` places that are `step` apart; rows follow each
// other as the places of a column do.
std::vector<double> SumAround(const std::vector<double>& values, int length, int step) {
  std::vector<double> sums(values.size(), 0.0);
  constexpr int reach = static_cast<int>(kWeights.size()) - 1;
  for (int place = 0; place < static_cast<int>(values.size()); ++place) {
    const int along = place / step % length;
    double sum = 0;
    for (int d = std::max(-reach, -along); d <= std::min(reach, length - 1 - along); ++d) {
      const int other = place + d * step;
      sum += kWeights[static_cast<size_t>(std::abs(d))] * values[static_cast<size_t>(other)];
    }
    sums[static_cast<size_t>(place)] = sum;
  }
  return sums;
}

std::vector<double> SumAround(const std::vector<double>& values, int width) {
  const int height = static_cast<int>(values.size()) / width;
  return SumAround(SumAround(values, width, 1), height, width);
}

}  // namespace

TileGoal FirstGoal(const FrameSpec& spec) {
  if (!spec.IsAdaptive() || spec.samples_per_pixel <= kDecisionSamplesMin)
    return {spec.samples_per_pixel, true, {}};
  return {kDecisionSamplesMin, false, {}};
}

TileGoal NextGoal(const FrameSpec& spec, uint32_t samples, PixelMask pixels) {
  const uint32_t next = std::min(samples * 2, spec.samples_per_pixel);
  return {next, next == spec.samples_per_pixel, std::move(pixels)};
}

uint32_t FirstUnitMax(const FrameSpec& spec) {
  const TileGoal first = FirstGoal(spec);
  return first.is_final ? first.samples : first.samples / 2;
}

bool IsUnitRange(const FrameSpec& spec, SampleRange range) {
  return range.IsDyadic() && range.end() <= spec.samples_per_pixel &&
         (range.begin > 0 || range.size <= FirstUnitMax(spec));
}

std::vector<SampleRange> UnitPartition(const FrameSpec& spec, uint32_t samples) {
  std::vector<SampleRange> ranges;
  for (uint32_t begin = 0; begin < samples; begin = ranges.back().end()) {
    const uint32_t end = begin == 0 ? std::min(samples, FirstUnitMax(spec)) : samples;
    ranges.push_back({begin, DyadicSizeMax(begin, end)});
  }
  return ranges;
}

double PixelNoise(const ChannelLayout& layout, const float* left, const float* right) {
  const double left_weight = left[layout.weight()];
  const double right_weight = right[layout.weight()];
  double total = 0;
  for (const size_t c : layout.colors()) {
    const double left_sum = left[c];
    const double right_sum = right[c];
    const double mean = Mean(left_sum + right_sum, left_weight + right_weight);
    const double error = (Mean(left_sum, left_weight) - Mean(right_sum, right_weight)) / 2;
    total += error * error / (mean * mean + kSquaredMeanFloor);
  }
  return total / static_cast<double>(layout.colors().size());
}

std::vector<double> EstimateNoise(const ChannelLayout& layout, const TileHalves& halves) {
  const size_t stride = layout.shape().stride();
  const size_t pixels = halves.left.size() / stride;
  TESSERA_CHECK(layout.samples() && pixels > 0 && halves.left.size() == halves.right.size());
  TESSERA_CHECK(halves.left.size() % stride == 0 && pixels % static_cast<size_t>(halves.width) == 0);
  std::vector<double> open(pixels, 0.0);  // 1: has not stopped
  std::vector<double> noise(pixels, 0.0);
  double open_count = 0, noise_sum = 0;
  for (size_t p = 0; p < pixels; ++p) {
    if (SamplesOf(layout, halves, p) != static_cast<float>(halves.samples)) continue;
    open[p] = 1;
    noise[p] = PixelNoise(layout, &halves.left[p * stride], &halves.right[p * stride]);
    open_count += 1;
    noise_sum += noise[p];
  }
  const std::vector<double> noise_around = SumAround(noise, halves.width);
  const std::vector<double> open_around = SumAround(open, halves.width);
  for (size_t p = 0; p < pixels; ++p) {
    if (open[p] == 0) continue;
    noise[p] = (1 - kTileShare) * (noise_around[p] / open_around[p]) + kTileShare * (noise_sum / open_count);
  }
  return noise;
}

PixelMask NoisyPixels(const ChannelLayout& layout, double noise_threshold, const TileHalves& halves) {
  const double limit = noise_threshold * noise_threshold * halves.samples / kThresholdSamples;
  const std::vector<double> noise = EstimateNoise(layout, halves);
  std::vector<bool> noisy(noise.size());
  for (size_t p = 0; p < noise.size(); ++p) {
    noisy[p] = SamplesOf(layout, halves, p) == static_cast<float>(halves.samples) && !(noise[p] < limit);
  }
  return PixelMask::Of(noisy);
}

float SamplesOf(const ChannelLayout& layout, const TileHalves& halves, size_t pixel) {
  const size_t place = pixel * layout.shape().stride() + *layout.samples();
  return halves.left[place] + halves.right[place];
}

bool HasExactly(const ChannelLayout& layout, const PixelMask& pixels, const RadianceTile& tile) {
  const size_t stride = layout.shape().stride();
  for (size_t p = 0; p < static_cast<size_t>(tile.bounds.area()); ++p) {
    const float* values = &tile.sums[p * stride];
    const bool fits = pixels.Has(p)
                          ? values[*layout.samples()] == static_cast<float>(tile.range.size)
                          : std::all_of(values, values + stride, [](float value) { return value == 0; });
    if (!fits) return false;
  }
  return true;
}

}  // namespace tessera
