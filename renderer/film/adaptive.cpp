#include "film/adaptive.h"

#include <algorithm>

#include "util/check.h"

namespace tessera {
namespace {

constexpr double kRelativeFloor = 0.01;  // added to the square of a mean, as relMSE has it

// The channels that decide: those of colour.
std::vector<size_t> ColorChannels(const FrameSpec& spec) {
  std::vector<size_t> places;
  for (size_t c = 0; c < spec.channels.size(); ++c) {
    if (IsColorChannel(spec.channels[c])) places.push_back(c);
  }
  return places;
}

double Mean(double sum, double weight) {
  return weight != 0 ? sum / weight : 0;
}

}  // namespace

TileGoal FirstGoal(const FrameSpec& spec) {
  if (!spec.IsAdaptive() || spec.samples_per_pixel <= kDecisionSamplesMin)
    return {spec.samples_per_pixel, true};
  return {kDecisionSamplesMin, false};
}

TileGoal NextGoal(const FrameSpec& spec, uint32_t samples) {
  const uint32_t next = std::min(samples * 2, spec.samples_per_pixel);
  return {next, next == spec.samples_per_pixel};
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

double EstimateNoise(const FrameSpec& spec, const std::vector<float>& left, const std::vector<float>& right) {
  const size_t channels = spec.channels.size();
  TESSERA_CHECK(left.size() == right.size() && left.size() % channels == 0 && !left.empty());
  const std::vector<size_t> colors = ColorChannels(spec);
  double total = 0;
  for (size_t pixel = 0; pixel < left.size(); pixel += channels) {
    const double left_weight = left[pixel + channels - 1];
    const double right_weight = right[pixel + channels - 1];
    for (const size_t c : colors) {
      const double left_sum = left[pixel + c];
      const double right_sum = right[pixel + c];
      const double mean = Mean(left_sum + right_sum, left_weight + right_weight);
      const double error = (Mean(left_sum, left_weight) - Mean(right_sum, right_weight)) / 2;
      total += error * error / (mean * mean + kRelativeFloor);
    }
  }
  const size_t values = left.size() / channels * colors.size();
  return total / static_cast<double>(values);
}

bool IsEnough(const FrameSpec& spec, uint32_t samples, const std::vector<float>& left,
              const std::vector<float>& right) {
  const double noise = EstimateNoise(spec, left, right);
  return noise * kThresholdSamples < spec.noise_threshold * spec.noise_threshold * samples;
}

}  // namespace tessera
