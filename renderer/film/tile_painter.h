// Turns merged values into those of a picture: means, nearest values, ids by rank.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "renderer/film/channel_layout.h"
#include "renderer/film/merge_rules.h"

namespace tessera {

// Walks over the pixels of a tile.
class PixelSource {
 public:
  // `samples`: what each pixel has, unless the layout keeps counts. `values` must outlive this.
  PixelSource(const ChannelLayout& layout, size_t pixels, std::span<const float> values, uint32_t samples);
  // Goes to the next pixel, at first to the first one.
  void Next();
  float samples() const { return samples_; }
  float Value(size_t slot) const { return record_[slot]; }
  float Mean(size_t slot) const {
    const float weight = record_[layout_.weight()];
    return weight != 0 ? record_[slot] / weight : 0.0f;
  }
  // By decreasing weight, of equal ones by increasing bits of the id.
  const IdSet& Ranked(size_t set) const { return ranked_[set]; }

 private:
  const ChannelLayout& layout_;
  const float* next_;
  const float* record_ = nullptr;
  IdReader ids_;
  std::vector<IdSet> ranked_;
  float samples_;
};

class TilePainter {
 public:
  // `channels` are those of the picture. The layout must outlive this.
  TilePainter(std::vector<PictureChannel> channels, const ChannelLayout& layout);
  const ChannelLayout& layout() const { return layout_; }
  std::vector<std::string> Names() const;
  // Writes one value for each name.
  void Paint(const PixelSource& pixel, float* out) const;

 private:
  // The value of a channel that is no mean.
  float Derived(const PixelSource& pixel, size_t index) const;

  const ChannelLayout& layout_;
  std::vector<PictureChannel> channels_;
  std::vector<size_t> slots_;     // of each of them
  std::vector<size_t> operands_;  // three of each of them
};

}  // namespace tessera
