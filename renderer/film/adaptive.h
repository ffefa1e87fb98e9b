// Adaptive sampling: which pixels of a tile have enough samples, decided from the tile's own sums.
//
// The halves [0, n/2) and [n/2, n) of a doubling are two independent renderings L and R with half the samples
// each, and both are nodes of the sample tree. (L - R) / 2 has the same error as their mean M, so the mean
// over the colours of
//     q = ((L - R) / 2)^2 / (M^2 + 0.01)
// estimates the relMSE of a pixel of M, though poorly, because it is one difference. The decision therefore
// uses
//     noise = 3/4 of the mean of q around the pixel + 1/4 of the mean of q over the tile
// Both means are over the pixels of the tile that have not stopped before. "Around" weights them by binomial
// coefficients, which approximate a Gaussian of 2 pixels and are exact numbers.
//
// A pixel stops at n samples if noise < E^2 n / 256, where E is the threshold of the frame. The limit grows
// with n because relMSE falls as V / n: for a given total number of samples the error of the frame is least
// if the samples of a pixel are in proportion to the root of its variance V (Neyman 1934), and there V / n^2
// is the same for all pixels. A limit that is equal for all n gives each pixel samples in proportion to V,
// and such a frame is no better than one with the same number of samples everywhere.
//
// Bias: a pixel that stops because of its own samples may have missed the bright ones (Kirk and Arvo 1991).
// Three things limit this. If the errors have no skew, the difference of L and R is independent of their
// mean. A rare bright sample does have skew, but the pixels around and a quarter of the tile count as well.
// And M is also in the divisor, so that q is at most 1: one bright sample, seen or missed, changes the
// decision only where the noise is close to the threshold. Leaving a pixel's own q out of its noise would
// remove the bias, but also half of the savings, since the pixels that have met a bright sample are those
// that need more. Measured on even noise with many fireflies: 0.1 % of the mean at 150 samples per pixel,
// 0.25 % at 50.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/film/frame_spec.h"
#include "renderer/film/pixel_mask.h"
#include "renderer/film/sample_range.h"

namespace tessera {

struct RadianceTile;

// Added to the square of a mean, as relMSE has it.
constexpr double kSquaredMeanFloor = 0.01;

// The number of samples at which the limit is the threshold itself.
constexpr uint32_t kThresholdSamples = 256;
// The number of samples per pixel at the first decision. An earlier one saves nothing at useful thresholds
// and costs one more result per tile.
constexpr uint32_t kDecisionSamplesMin = 32;

// Samples [0, samples) of a tile are wanted: those before the last decision of all pixels, the later ones
// only of `pixels`. If final, no more samples will be wanted.
struct TileGoal {
  uint32_t samples = 0;
  bool is_final = false;
  PixelMask pixels;
  bool operator==(const TileGoal&) const = default;
};

// The goal before the first decision. It is final if the frame is not adaptive or has too few samples to be.
TileGoal FirstGoal(const FrameSpec& spec);
// The goal after a decision at `samples` samples that `pixels` need more.
TileGoal NextGoal(const FrameSpec& spec, uint32_t samples, PixelMask pixels);

// The largest size of a unit that starts at sample 0. No unit of an adaptive frame contains both halves of a
// doubling, so that each half is known. Units that start later cannot contain both.
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

// q of one pixel, from its records in the two halves.
double PixelNoise(const ChannelLayout& layout, const float* left, const float* right);
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
