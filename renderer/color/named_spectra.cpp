#include "renderer/color/named_spectra.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "renderer/color/spectral_data.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

// Linear interpolation at `lambda` between the samples around it; `lambda` lies between the first and the
// last.
float Interpolate(std::span<const float> wavelengths, std::span<const float> values, float lambda) {
  const auto above = std::upper_bound(wavelengths.begin(), wavelengths.end(), lambda);
  if (above == wavelengths.end()) return values.back();
  const size_t i = static_cast<size_t>(above - wavelengths.begin());
  const float t = (lambda - wavelengths[i - 1]) / (wavelengths[i] - wavelengths[i - 1]);
  return (1 - t) * values[i - 1] + t * values[i];
}

enum class Beyond { kZero, kConstant };  // what a spectrum is outside its samples

DenseTable Tabulate(std::span<const float> wavelengths, std::span<const float> values, Beyond beyond) {
  TESSERA_CHECK(wavelengths.size() == values.size());
  DenseTable table{};
  if (values.empty()) return table;
  for (int i = 0; i < kLambdaCount; ++i) {
    float lambda = static_cast<float>(kLambdaMin + i);
    if (beyond == Beyond::kConstant) lambda = std::clamp(lambda, wavelengths.front(), wavelengths.back());
    if (lambda < wavelengths.front() || lambda > wavelengths.back()) continue;
    table[static_cast<size_t>(i)] = Interpolate(wavelengths, values, lambda);
  }
  return table;
}

DenseTable TabulateSeries(const SpectralSeries& series) {
  if (!series.wavelengths.empty()) return Tabulate(series.wavelengths, series.values, Beyond::kConstant);
  std::vector<float> wavelengths;
  for (size_t i = 0; i < series.values.size(); ++i) {
    wavelengths.push_back(series.first + static_cast<float>(i) * series.step);
  }
  return Tabulate(wavelengths, series.values, Beyond::kConstant);
}

// Scales the table so that its integral with y-bar is kCieYIntegral.
void NormalizeLuminance(DenseTable& table) {
  double luminance = 0;
  for (size_t i = 0; i < table.size(); ++i) {
    luminance += static_cast<double>(table[i]) * static_cast<double>(CieY()[i]);
  }
  const float scale = static_cast<float>(static_cast<double>(kCieYIntegral) / luminance);
  for (float& value : table) value *= scale;
}

struct Library {
  std::map<std::string_view, std::shared_ptr<const DenseTable>> tables;
  std::vector<std::string_view> names;
};

Library MakeLibrary() {
  Library library;
  const auto add = [&](const SpectralSeries& series, bool normalize) {
    DenseTable table = TabulateSeries(series);
    if (normalize) NormalizeLuminance(table);
    library.tables[series.name] = std::make_shared<const DenseTable>(table);
    library.names.push_back(series.name);
  };
  for (const SpectralSeries& series : GlassSeries()) add(series, false);
  for (const SpectralSeries& series : MetalSeries()) add(series, false);
  for (const SpectralSeries& series : IlluminantSeries()) add(series, true);
  for (const SpectralSeries& series : SensorSeries()) add(series, false);
  return library;
}

const Library& TheLibrary() {
  static const Library library = MakeLibrary();
  return library;
}

}  // namespace

const DenseTable& CieX() {
  return kCieXBar;
}
const DenseTable& CieY() {
  return kCieYBar;
}
const DenseTable& CieZ() {
  return kCieZBar;
}

std::shared_ptr<const DenseTable> NamedSpectrum(std::string_view name) {
  const auto& tables = TheLibrary().tables;
  const auto found = tables.find(name);
  return found == tables.end() ? nullptr : found->second;
}

std::span<const std::string_view> NamedSpectrumNames() {
  return TheLibrary().names;
}

std::span<const std::string_view> SensorNames() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> sensors;
    constexpr size_t kColours = 3, kSuffix = 2;
    for (size_t i = 0; i < SensorSeries().size(); i += kColours) {
      std::string_view name = SensorSeries()[i].name;
      name.remove_suffix(kSuffix);
      sensors.push_back(name);
    }
    return sensors;
  }();
  return names;
}

std::span<const DenseTable> ColorCheckerPatches() {
  static const std::vector<DenseTable> patches = [] {
    std::vector<DenseTable> tables;
    for (const SpectralSeries& series : ColorCheckerSeries()) tables.push_back(TabulateSeries(series));
    return tables;
  }();
  return patches;
}

std::shared_ptr<const DenseTable> TableFromSamples(std::span<const float> wavelengths,
                                                   std::span<const float> values) {
  return std::make_shared<const DenseTable>(Tabulate(wavelengths, values, Beyond::kZero));
}

float BlackbodyValue(float kelvin, float lambda) {
  if (!(kelvin > 0)) return 0;
  constexpr float kSecondRadiation = 1.4387770e7f;  // h c / k in nm K (CODATA 2010)
  constexpr float kWien = 2.8977721e6f;             // wavelength of the maximum times temperature, in nm K
  constexpr float kExponentAtPeak = kSecondRadiation / kWien;
  static const float at_peak = std::expm1(kExponentAtPeak);
  const float ratio = (kWien / kelvin) / lambda;  // to the wavelength of the maximum
  const float fifth_power = ratio * ratio * ratio * ratio * ratio;
  // Infinity in the denominator, for very low temperatures, makes a zero; both infinite are ruled out here.
  const float denominator = std::expm1(kExponentAtPeak * ratio);
  return std::isinf(denominator) ? 0 : fifth_power * at_peak / denominator;
}

std::shared_ptr<const DenseTable> Blackbody(float kelvin) {
  DenseTable table{};
  for (int i = 0; i < kLambdaCount; ++i)
    table[static_cast<size_t>(i)] = BlackbodyValue(kelvin, static_cast<float>(kLambdaMin + i));
  return std::make_shared<const DenseTable>(table);
}

std::shared_ptr<const DenseTable> DaylightIlluminant(float kelvin) {
  // The CIE's formula assumes h c / k = 1.438 cm K; below 4000 K it is not defined.
  const float cct = kelvin * (1.4388f / 1.4380f);
  if (cct < 4000) return Blackbody(cct);
  const float inverse = 1000 / cct;
  const float x = cct <= 7000 ? ((-4.607f * inverse + 2.9678f) * inverse + 0.09911f) * inverse + 0.244063f
                              : ((-2.0064f * inverse + 1.9018f) * inverse + 0.24748f) * inverse + 0.23704f;
  const float y = (-3 * x + 2.870f) * x - 0.275f;
  const float divisor = 0.0241f + 0.2562f * x - 0.7341f * y;
  const float weight1 = (-1.3515f - 1.7703f * x + 5.9114f * y) / divisor;
  const float weight2 = (0.0300f - 31.4424f * x + 30.0717f * y) / divisor;
  std::array<float, kDaylightCount> wavelengths, values;
  for (size_t i = 0; i < values.size(); ++i) {
    wavelengths[i] =
        static_cast<float>(kLambdaMin) + static_cast<float>(i) * static_cast<float>(kDaylightStep);
    values[i] = (kDaylightS0[i] + weight1 * kDaylightS1[i] + weight2 * kDaylightS2[i]) * 0.01f;
  }
  return TableFromSamples(wavelengths, values);
}

}  // namespace tessera
