// The channels of the film "spectral": the mean radiance of each of several equal ranges of wavelengths,
// named and described as spectral OpenEXR files are (Fichet, Pacanowski, Wilkie 2021).
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "renderer/color/wavelengths.h"
#include "renderer/film/channel.h"
#include "renderer/film/channel_layout.h"

namespace tessera {

constexpr int kSpectralBucketsMax = 240;  // leaves room for the other channels of a picture

struct SpectralBuckets {
  int count = 0;  // 0: the film keeps none
  float first_nm = kLambdaMin, last_nm = kLambdaMax;
  // Bounds the largest of a sample's four radiances.
  float radiance_max = std::numeric_limits<float>::infinity();

  // Whether the names of their channels differ: those of ranges narrower than 0.001 nm may not.
  bool HaveDifferentNames() const;
  // Adds "S0.CENTREnm" for every bucket, the centre with three decimals after a comma.
  void AddChannels(std::vector<Channel>& channels) const;
  void AddAttributes(std::map<std::string, std::string>& attributes) const;
};

// Writes the radiance of samples into their values, by position.
class BucketRecorder {
 public:
  BucketRecorder(const SpectralBuckets& buckets, const ChannelLayout& layout);

  bool empty() const { return slots_.empty(); }
  // `values` are those of the sample, zero in the buckets.
  void Add(SampledSpectrum radiance, const SampledWavelengths& wavelengths, float filter_weight,
           float* values) const;

 private:
  SpectralBuckets buckets_;
  std::vector<size_t> slots_;
};

}  // namespace tessera
