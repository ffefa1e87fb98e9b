#include "renderer/film/tile_painter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace tessera {
namespace {

// The coverage of an id: its share of the filter weight of all samples.
float RankedValue(const PixelSource& pixel, const PictureChannel& channel, size_t set, float weight) {
  const IdSet& ranked = pixel.Ranked(set);
  if (channel.rank >= ranked.size()) return 0;
  const IdWeight& entry = ranked[channel.rank];
  if (channel.source == PictureChannel::Source::kRankedId) return entry.id;
  return weight != 0 ? entry.weight / weight : 0.0f;
}

// The variance of the mean of a colour. Samples add y = weight x colour, so the mean is sum(y) / sum(weight),
// and the variance of sum(y) is n times that of y, which the squares give.
float VarianceOfMean(double squares, double sum, double n, double weight) {
  if (!(n > 1) || weight == 0) return 0;
  const double variance = std::max(0.0, squares - sum * sum / n) / (n - 1);
  return static_cast<float>(variance * n / (weight * weight));
}

// The variance of n values.
double VarianceOfValues(double squares, double sum, double n) {
  return n > 1 ? std::max(0.0, squares - sum * sum / n) / (n - 1) : 0;
}

float OverHits(float sum, float weight) {
  return weight != 0 ? sum / weight : 0.0f;
}

float Component(float value, float x, float y, float z) {
  const float length = std::hypot(x, y, z);
  return length > 0 ? value / length : 0.0f;
}

}  // namespace

PixelSource::PixelSource(const ChannelLayout& layout, size_t pixels, std::span<const float> values,
                         uint32_t samples)
    : layout_(layout),
      next_(values.data()),
      ids_(layout.shape(), pixels, values),
      ranked_(layout.shape().id_sets),
      samples_(static_cast<float>(samples)) {}

void PixelSource::Next() {
  const PixelShape& shape = layout_.shape();
  record_ = next_;
  next_ += shape.stride();
  if (layout_.samples()) samples_ = record_[*layout_.samples()];
  for (size_t set = 0; set < shape.id_sets; ++set) {
    ranked_[set] = ids_.Next(record_[shape.stride() - shape.id_sets + set]);
    std::ranges::stable_sort(ranked_[set], std::ranges::greater(), &IdWeight::weight);
  }
}

TilePainter::TilePainter(std::vector<PictureChannel> channels, const ChannelLayout& layout)
    : layout_(layout), channels_(std::move(channels)) {
  for (const PictureChannel& channel : channels_) {
    slots_.push_back(layout.SlotOf(channel.channel).value_or(0));
    for (size_t i = 0; i < channel.operands.size(); ++i)
      operands_.push_back(layout.SlotOf(channel.operands[i]).value_or(0));
  }
}

std::vector<std::string> TilePainter::Names() const {
  std::vector<std::string> names;
  for (const PictureChannel& channel : channels_) names.push_back(channel.name);
  return names;
}

float TilePainter::Derived(const PixelSource& pixel, size_t index) const {
  using Source = PictureChannel::Source;
  const float value = pixel.Value(slots_[index]);
  const auto operand = [&](size_t i) { return pixel.Value(operands_[3 * index + i]); };
  switch (channels_[index].source) {
    case Source::kVariance:
      return VarianceOfMean(value, operand(0), pixel.samples(), pixel.Value(layout_.weight()));
    case Source::kHitMean: return OverHits(value, operand(0));
    case Source::kHitSlope: return std::abs(OverHits(value, operand(0)));
    case Source::kDirection: return Component(value, operand(0), operand(1), operand(2));
    case Source::kHitVariance: return static_cast<float>(VarianceOfValues(value, operand(0), operand(1)));
    case Source::kRelativeHitVariance: {
      const double mean = OverHits(operand(0), operand(1));
      return mean != 0 ? static_cast<float>(VarianceOfValues(value, operand(0), operand(1)) / mean) : 0.0f;
    }
    default: return value;
  }
}

void TilePainter::Paint(const PixelSource& pixel, float* out) const {
  using Source = PictureChannel::Source;
  for (size_t i = 0; i < channels_.size(); ++i) {
    const PictureChannel& channel = channels_[i];
    switch (channel.source) {
      case Source::kMean: out[i] = pixel.Mean(slots_[i]); break;
      case Source::kSamples: out[i] = pixel.samples(); break;
      case Source::kDepth: {
        const float depth = pixel.Value(slots_[i]);
        out[i] = depth > 0 ? depth : std::numeric_limits<float>::infinity();
        break;
      }
      default: out[i] = Derived(pixel, i); break;
      case Source::kRankedId:
      case Source::kRankedCoverage:
        out[i] = RankedValue(pixel, channel, layout_.IdSetOf(channel.channel), pixel.Value(layout_.weight()));
        break;
    }
  }
}

}  // namespace tessera
