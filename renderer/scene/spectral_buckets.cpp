#include "renderer/scene/spectral_buckets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderer/color/named_spectra.h"

namespace tessera {
namespace {

std::string NameOf(const SpectralBuckets& buckets, int bucket) {
  const float centre = (static_cast<float>(bucket) + 0.5f) / static_cast<float>(buckets.count);
  std::string number =
      fmt::format("{:.3f}", buckets.first_nm + centre * (buckets.last_nm - buckets.first_nm));
  std::ranges::replace(number, '.', ',');
  return "S0." + number + "nm";
}

}  // namespace

bool SpectralBuckets::HaveDifferentNames() const {
  for (int i = 1; i < count; ++i) {
    if (NameOf(*this, i - 1) == NameOf(*this, i)) return false;  // the centres rise
  }
  return true;
}

void SpectralBuckets::AddChannels(std::vector<Channel>& channels) const {
  for (int i = 0; i < count; ++i) AddChannel(channels, {NameOf(*this, i)});
}

void SpectralBuckets::AddAttributes(std::map<std::string, std::string>& attributes) const {
  if (count == 0) return;
  attributes["spectralLayoutVersion"] = "1.0";
  attributes["emissiveUnits"] = "W.m^-2.sr^-1";
}

BucketRecorder::BucketRecorder(const SpectralBuckets& buckets, const ChannelLayout& layout)
    : buckets_(buckets) {
  for (int i = 0; i < buckets.count; ++i) slots_.push_back(*layout.SlotOf(NameOf(buckets, i)));
}

void BucketRecorder::Add(SampledSpectrum radiance, const SampledWavelengths& wavelengths, float filter_weight,
                         float* values) const {
  float largest = 0;
  for (int i = 0; i < 4; ++i) largest = std::max(largest, radiance[i]);
  if (largest > buckets_.radiance_max) radiance = radiance * (buckets_.radiance_max / largest);
  // The integral over a bucket is estimated by the wavelengths in it over their densities. Lights are given
  // in photometric units, which kCieYIntegral takes back.
  const float width = (buckets_.last_nm - buckets_.first_nm) / static_cast<float>(buckets_.count);
  const SampledSpectrum parts = SafeDiv(radiance, wavelengths.pdf) * (kCieYIntegral / (4 * width));
  for (int i = 0; i < 4; ++i) {
    const float place = (wavelengths.lambda[i] - buckets_.first_nm) / width;
    if (!(place >= 0 && place < static_cast<float>(buckets_.count)) || !std::isfinite(parts[i])) continue;
    values[slots_[static_cast<size_t>(place)]] += parts[i] * filter_weight;
  }
}

}  // namespace tessera
