// Spectra: wavelengths, the forms of spectra, and the way from RGB to spectra.
#include <array>
#include <memory>

#include "renderer/color/color_space.h"
#include "renderer/color/wavelengths.h"
#include "tests/bench/micro/micro_bench.h"

namespace tessera {
namespace {

constexpr size_t kColors = 1024;

std::vector<SampledWavelengths> Wavelengths() {
  const NumberRing numbers(1);
  std::vector<SampledWavelengths> all;
  for (size_t i = 0; i < kColors; ++i) all.push_back(SampledWavelengths::SampleVisible(numbers.At(i)));
  return all;
}

std::vector<Rgb> Colors() {
  const NumberRing numbers(2);
  std::vector<Rgb> all;
  for (size_t i = 0; i < kColors; ++i)
    all.push_back({numbers.At(3 * i), numbers.At(3 * i + 1), numbers.At(3 * i + 2)});
  return all;
}

void AddForm(const std::string& name, const Spectrum& spectrum) {
  AddBenchmark("spectrum/sample/" + name, [spectrum, wavelengths = Wavelengths()](size_t i) {
    return spectrum.Sample(wavelengths[i % kColors]);
  });
}

void AddForms() {
  const std::shared_ptr<const DenseTable>& white = ColorSpace::Srgb().illuminant();
  const SigmoidPolynomial polynomial = ColorSpace::Srgb().AlbedoPolynomial({0.7f, 0.4f, 0.1f});
  AddForm("constant", Spectrum::Constant(0.5f));
  AddForm("sigmoid", Spectrum::Sigmoid(polynomial, 0.9f));
  AddForm("table", Spectrum::Table(white));
  AddForm("sigmoid_times_table", Spectrum::SigmoidTimesTable(polynomial, white, 2));
}

void AddUses() {
  const std::array<std::pair<const char*, SpectrumUse>, 3> uses{{{"albedo", SpectrumUse::kAlbedo},
                                                                 {"unbounded", SpectrumUse::kUnbounded},
                                                                 {"illuminant", SpectrumUse::kIlluminant}}};
  for (const auto& [name, use] : uses) {
    AddBenchmark(std::string("spectrum/rgb_texel_to_sampled/") + name,
                 [use = use, colors = Colors(), wavelengths = Wavelengths()](size_t i) {
                   return ColorSpace::Srgb().SampleFast(colors[i % kColors], use, wavelengths[i % kColors]);
                 });
    AddBenchmark(std::string("spectrum/rgb_to_spectrum/") + name, [use = use, colors = Colors()](size_t i) {
      return ColorSpace::Srgb().ToSpectrum(colors[i % kColors], use).At(550);
    });
  }
}

}  // namespace

void AddSpectrumBenchmarks() {
  AddBenchmark("spectrum/sample_wavelengths", [numbers = NumberRing(3)](size_t i) {
    return SampledWavelengths::SampleVisible(numbers.At(i));
  });
  AddForms();
  AddUses();
  AddBenchmark("spectrum/uplift_by_table", [colors = Colors()](size_t i) {
    return ColorSpace::Srgb().AlbedoPolynomialFast(colors[i % kColors]);
  });
  for (const char* const space : {"srgb", "dci-p3", "rec2020", "aces2065-1"}) {
    AddBenchmark(std::string("spectrum/uplift_exactly/") + space,
                 [space = ColorSpace::Named(space), colors = Colors()](size_t i) {
                   return space->AlbedoPolynomial(colors[i % kColors]);
                 });
  }
}

}  // namespace tessera
