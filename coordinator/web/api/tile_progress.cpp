#include "coordinator/web/api/tile_progress.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/film/adaptive.h"
#include "renderer/film/merge_rules.h"

namespace tessera {
namespace {

constexpr int kReach = 2;  // a single difference says little: 25 of them are averaged

// The nodes that are shown: those of a prefix if there is one, otherwise all.
FrameSnapshot::TileNodes Shown(const FrameSnapshot::TileNodes& nodes) {
  const bool has_prefix = !nodes.empty() && nodes.front().first.begin == 0;
  FrameSnapshot::TileNodes shown;
  uint32_t samples = 0;
  for (const auto& node : nodes) {
    if (has_prefix && node.first.begin != samples) break;
    samples += node.first.size;
    shown.push_back(node);
  }
  return shown;
}

// Two independent estimates of a pixel.
struct Part {
  const float* record = nullptr;
  double samples = 0;
};

// ((a - b)^2 / (1 / n_a + 1 / n_b)) estimates the variance of a sample, and that over n_a + n_b that of the
// mean of all. With equal parts it is q of film/adaptive.h.
double RelativeError(const ChannelLayout& layout, const Part& a, const Part& b) {
  const double weight_a = a.record[layout.weight()], weight_b = b.record[layout.weight()];
  if (weight_a == 0 || weight_b == 0 || a.samples <= 0 || b.samples <= 0) return 0;
  const double all = a.samples + b.samples;
  double total = 0;
  for (const size_t c : layout.colors()) {
    const double difference = a.record[c] / weight_a - b.record[c] / weight_b;
    const double mean = (double{a.record[c]} + b.record[c]) / (weight_a + weight_b);
    total +=
        difference * difference * a.samples * b.samples / (all * all) / (mean * mean + kSquaredMeanFloor);
  }
  return total / static_cast<double>(layout.colors().size());
}

// The root of the mean around each pixel.
std::vector<float> Smooth(const std::vector<double>& values, int width, int height) {
  std::vector<float> smooth;
  smooth.reserve(values.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      int count = 0;
      for (int j = std::max(y - kReach, 0); j <= std::min(y + kReach, height - 1); ++j) {
        const size_t row = static_cast<size_t>(j) * static_cast<size_t>(width);
        for (int i = std::max(x - kReach, 0); i <= std::min(x + kReach, width - 1); ++i, ++count)
          sum += values[row + static_cast<size_t>(i)];
      }
      smooth.push_back(static_cast<float>(std::sqrt(sum / count)));
    }
  }
  return smooth;
}

}  // namespace

std::vector<float> SamplesOfTile(const FrameSpec& spec, const FrameSnapshot::TileNodes& nodes,
                                 const PixelBounds& bounds) {
  const ChannelLayout layout = spec.Layout();
  const size_t stride = layout.shape().stride();
  std::vector<float> samples(static_cast<size_t>(bounds.area()), 0.0f);
  for (const auto& [range, sums] : Shown(nodes)) {
    for (size_t p = 0; p < samples.size(); ++p)
      samples[p] +=
          layout.samples() ? (*sums)[p * stride + *layout.samples()] : static_cast<float>(range.size);
  }
  return samples;
}

std::optional<std::vector<float>> NoiseOfTile(const FrameSpec& spec, const FrameSnapshot::TileNodes& nodes,
                                              const PixelBounds& bounds) {
  const FrameSnapshot::TileNodes shown = Shown(nodes);
  const ChannelLayout layout = spec.Layout();
  if (shown.size() < 2 || layout.colors().empty()) return std::nullopt;
  const auto pixels = static_cast<size_t>(bounds.area());
  std::vector<float> rest = *shown[1].second;
  double rest_samples = shown[1].first.size;
  for (size_t i = 2; i < shown.size(); ++i) {
    MergeSiblings(layout.shape(), pixels, rest, *shown[i].second, rest);
    rest_samples += shown[i].first.size;
  }
  const std::vector<float>& first = *shown[0].second;
  const size_t stride = layout.shape().stride();
  std::vector<double> errors(pixels);
  for (size_t p = 0; p < pixels; ++p) {
    Part a{&first[p * stride], static_cast<double>(shown[0].first.size)}, b{&rest[p * stride], rest_samples};
    if (layout.samples()) {
      a.samples = a.record[*layout.samples()];
      b.samples = b.record[*layout.samples()];
    }
    errors[p] = RelativeError(layout, a, b);
  }
  return Smooth(errors, bounds.width(), bounds.height());
}

std::optional<std::vector<float>> NoiseFromVariance(const std::vector<std::string>& channels,
                                                    std::span<const float> values) {
  std::array<size_t, 6> places{};
  constexpr const char* kNames[] = {"R", "G", "B", "variance.R", "variance.G", "variance.B"};
  for (size_t i = 0; i < places.size(); ++i) {
    const auto found = std::ranges::find(channels, kNames[i]);
    if (found == channels.end()) return std::nullopt;
    places[i] = static_cast<size_t>(found - channels.begin());
  }
  std::vector<float> noise;
  for (size_t at = 0; at + channels.size() <= values.size(); at += channels.size()) {
    double total = 0;
    for (size_t c = 0; c < 3; ++c) {
      const double mean = values[at + places[c]];
      total += values[at + places[3 + c]] / (mean * mean + kSquaredMeanFloor);
    }
    noise.push_back(static_cast<float>(std::sqrt(std::max(total, 0.0) / 3)));
  }
  return noise;
}

}  // namespace tessera
