// Adaptive sampling: how a tile's own sums decide which of its pixels have samples enough.
//
// The halves [0, n/2) and [n/2, n) of a doubling are two renderings L and R of half the samples: two
// half-buffers that come through the tree by themselves. (L - R) / 2 errs as their mean M does, so the mean
// over the colours of
//     q = ((L - R) / 2)^2 / (M^2 + 0.01)
// estimates the relMSE of a pixel of M, if badly: one difference is all that it knows. What a pixel is judged
// by is therefore
//     noise = 3/4 of the mean of q around the pixel + 1/4 of the mean of q over the tile
// where both take those pixels of the tile that have not stopped before, and "around" weighs them by binomial
// coefficients, nearly a Gaussian of 2 pixels, so that every weight is an exact number.
//
// A pixel stops at n if noise < E^2 n / 256 with the frame's threshold E. Not at E for all n: relMSE falls as
// V / n, so for a given number of samples in all the frame's is least if pixels get them in proportion to the
// root of their variance V (Neyman 1934), which is where V / n^2 is the same for all. A threshold equal for
// all pixels gives each of them n in proportion to V, and such a frame is no better than one with as many
// samples everywhere.
//
// Bias: a pixel that stops by its own samples may stop because it has missed the bright ones (Kirk and Arvo
// 1991). What guards against it: for errors without skew the difference of L and R tells nothing of their
// mean. For the rare bright sample that does have skew, those around a pixel, and a quarter of the whole
// tile, speak for it, too; and M is also in the divisor, so that q is never above 1: one bright sample, seen
// or missed, moves the decision only where noise is that near to the threshold, while many keep the pixels
// open as they should. To leave a pixel's own q out of its noise would leave no bias, and half of the
// savings: it is those that have met a bright sample that need more. Measured, on even noise with many
// fireflies: 0.1 % of the mean at 150 samples per pixel, 0.25 % at 50.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/film/frame_spec.h"
#include "renderer/film/pixel_mask.h"
#include "renderer/film/sample_range.h"

namespace tessera {

struct RadianceTile;

// The threshold itself is that of a pixel with so many samples.
constexpr uint32_t kThresholdSamples = 256;
// The first decision is taken when so many samples of each pixel are there: to ask earlier saves nothing at
// thresholds of use, and costs a result more per tile.
constexpr uint32_t kDecisionSamplesMin = 32;

// Samples [0, samples) of a tile are wanted: of all pixels those before the last decision, then of `pixels`
// alone. If final, no more ever will be.
struct TileGoal {
  uint32_t samples = 0;
  bool is_final = false;
  PixelMask pixels;
  bool operator==(const TileGoal&) const = default;
};

// Before anything of a tile is known. Final for a frame that is not adaptive, or too small to be.
TileGoal FirstGoal(const FrameSpec& spec);
// After a decision at `samples` to go on with `pixels`.
TileGoal NextGoal(const FrameSpec& spec, uint32_t samples, PixelMask pixels);

// How many samples a unit that begins with sample 0 may have: no unit of an adaptive frame reaches over a
// doubling, so that its halves are known each for itself. Units that begin later cannot reach over one.
uint32_t FirstUnitMax(const FrameSpec& spec);
// Whether samples `range` of a tile can be a unit of the frame.
bool IsUnitRange(const FrameSpec& spec, SampleRange range);
// Samples [0, samples) of the frame as the largest ranges that can be units, in order.
std::vector<SampleRange> UnitPartition(const FrameSpec& spec, uint32_t samples);

// The two halves of the first `samples` samples of a tile of an adaptive frame: the records of its pixels
// (channel_layout.h).
struct TileHalves {
  uint32_t samples = 0;
  int width = 0;  // of the tile, in pixels
  std::span<const float> left;
  std::span<const float> right;
};

// The relMSE that the sum of the two halves is expected to have at each pixel; 0 where the pixel has stopped
// before.
std::vector<double> EstimateNoise(const ChannelLayout& layout, const TileHalves& halves);
// The pixels that want more samples.
PixelMask NoisyPixels(const ChannelLayout& layout, double noise_threshold, const TileHalves& halves);

// The number of samples that a pixel of an adaptive frame has in both halves.
float SamplesOf(const ChannelLayout& layout, const TileHalves& halves, size_t pixel);
// Whether a tile of an adaptive frame has all samples of its range of these pixels, and nothing of others.
bool HasExactly(const ChannelLayout& layout, const PixelMask& pixels, const RadianceTile& tile);

}  // namespace tessera
