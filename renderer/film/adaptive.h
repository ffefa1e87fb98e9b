// Adaptive sampling: how a tile's own sums decide when its samples are enough.
//
// The halves [0, n/2) and [n/2, n) of a doubling are two renderings L and R of half the samples: two
// half-buffers that come through the tree by themselves. (L - R) / 2 errs as their mean M does, so over the
// pixels and colours of the tile
//     noise = mean of ((L - R) / 2)^2 / (M^2 + 0.01)
// estimates the relMSE of M. Samplers that spread their points make M better than that; where fireflies are,
// it is worse, since the estimate of a pixel is never above 1.
//
// The tile stops at n if noise < E^2 n / 256 with the frame's threshold E. Not at E for all n: relMSE falls
// as V / n, so for a given number of samples in all the frame's is least if tiles get them in proportion to
// the root of their variance V (Neyman 1934), which is where V / n^2 is the same for all. A threshold equal
// for all tiles gives each of them n in proportion to V, and such a frame is no better than one with as many
// samples everywhere.
//
// Bias: a tile that stops by its own samples may stop because it has missed the bright ones (Kirk and Arvo
// 1991). What guards against it: for errors without skew the difference of L and R tells nothing of their
// mean. For the rare bright sample that does have skew, M is also in the divisor, so that no pixel adds more
// than its share, 1 / pixels: one such sample, seen or missed, moves the decision only where noise is that
// near to the threshold, while many keep the tile open as they should. And the fewer samples a tile has, the
// lower the noise at which it may stop. Tiles of 16 x 16 pixels moved the mean of pictures by less than 0.1 %
// where no fireflies hid it, tiles of 8 x 8 by 0.2 %.
#pragma once

#include <cstdint>
#include <vector>

#include "film/frame_spec.h"
#include "film/sample_range.h"

namespace tessera {

// The threshold itself is that of a tile with so many samples per pixel.
constexpr uint32_t kThresholdSamples = 256;
// The first decision is taken when so many samples of each pixel are there: to ask earlier saves nothing at
// thresholds of use, and costs a result more per tile.
constexpr uint32_t kDecisionSamplesMin = 32;

// Samples [0, samples) of each pixel of a tile are wanted; if final, no more ever will be.
struct TileGoal {
  uint32_t samples = 0;
  bool is_final = false;
  bool operator==(const TileGoal&) const = default;
};

// Before anything of a tile is known. Final for a frame that is not adaptive, or too small to be.
TileGoal FirstGoal(const FrameSpec& spec);
// After a decision to go on, taken at `samples`.
TileGoal NextGoal(const FrameSpec& spec, uint32_t samples);

// How many samples a unit that begins with sample 0 may have: no unit of an adaptive frame reaches over a
// doubling, so that its halves are known each for itself. Units that begin later cannot reach over one.
uint32_t FirstUnitMax(const FrameSpec& spec);
// Whether samples `range` of a tile can be a unit of the frame.
bool IsUnitRange(const FrameSpec& spec, SampleRange range);
// Samples [0, samples) of the frame as the largest ranges that can be units, in order.
std::vector<SampleRange> UnitPartition(const FrameSpec& spec, uint32_t samples);

// The relMSE that the sum of the two halves of a tile's samples is expected to have. Both hold the sums of
// every channel of the frame, pixel by pixel.
double EstimateNoise(const FrameSpec& spec, const std::vector<float>& left, const std::vector<float>& right);
// Whether a tile with these halves, of `samples` samples together, stops.
bool IsEnough(const FrameSpec& spec, uint32_t samples, const std::vector<float>& left,
              const std::vector<float>& right);

}  // namespace tessera
