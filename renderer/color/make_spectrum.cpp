#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "renderer/color/named_spectra.h"
#include "renderer/color/spectrum_parameter.h"
#include "renderer/description/number_list.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr size_t kSpectrumFileSizeMax = size_t{1} << 20;  // bytes: 30,000 samples and more
constexpr float kKelvinMax = 1e8f;  // far beyond every star, and safe in Planck's formula

Spectrum FromTable(std::shared_ptr<const DenseTable> table, SpectrumUse use) {
  // More light than came in cannot leave.
  if (use == SpectrumUse::kAlbedo &&
      std::any_of(table->begin(), table->end(), [](float v) { return v > 1; })) {
    DenseTable clamped = *table;
    for (float& value : clamped) value = std::min(value, 1.0f);
    table = std::make_shared<const DenseTable>(clamped);
  }
  return Spectrum::Table(std::move(table));
}

Result<Spectrum> FromRgb(const SpectrumValue& value, SpectrumUse use) {
  const ColorSpace* space =
      value.color_space.empty() ? &ColorSpace::Srgb() : ColorSpace::Named(value.color_space);
  if (space == nullptr) {
    return ErrorAt(value.location, fmt::format("unknown colour space \"{}\"", value.color_space));
  }
  for (int i = 0; i < 3; ++i) {
    const float component = value.rgb[i];
    if (!(component >= 0) || std::isinf(component)) {
      return ErrorAt(value.location, fmt::format("RGB component {} is negative or not finite", component));
    }
    if (use == SpectrumUse::kAlbedo && component > 1) {
      return ErrorAt(value.location, fmt::format("RGB component {} of a reflectance is above 1", component));
    }
  }
  return space->ToSpectrum(value.rgb, use);
}

// Why the samples make no spectrum, or "".
std::string SamplesProblem(std::span<const float> wavelengths, std::span<const float> values) {
  if (wavelengths.size() != values.size()) return "a wavelength has no value";
  if (wavelengths.empty()) return "there are no samples";
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(wavelengths[i]) || !std::isfinite(values[i])) return "a sample is not finite";
    if (values[i] < 0) return fmt::format("the value {} at {} nm is negative", values[i], wavelengths[i]);
    if (i > 0 && !(wavelengths[i] > wavelengths[i - 1])) {
      return fmt::format("the wavelengths do not increase: {} nm follows {} nm", wavelengths[i],
                         wavelengths[i - 1]);
    }
  }
  return "";
}

Result<Spectrum> FromSamples(const SpectrumValue& value, SpectrumUse use) {
  const std::string problem = SamplesProblem(value.wavelengths, value.values);
  if (!problem.empty()) return ErrorAt(value.location, "bad spectrum: " + problem);
  return FromTable(TableFromSamples(value.wavelengths, value.values), use);
}

struct Samples {
  std::vector<float> wavelengths, values;
};

// The pairs of a file of wavelengths (nm) and values.
Result<Samples> ParseSamples(const std::string& text) {
  const Result<std::vector<float>> numbers = ParseNumberList(text);
  if (!numbers) return numbers.error();
  Samples samples;
  for (size_t i = 0; i < numbers->size(); ++i) {
    (i % 2 == 0 ? samples.wavelengths : samples.values).push_back((*numbers)[i]);
  }
  return samples;
}

Result<Spectrum> FromFile(const SpectrumValue& value, SpectrumUse use, FileSource& files) {
  const auto fail = [&](const std::string& problem) {
    return ErrorAt(value.location, fmt::format("spectrum file \"{}\": {}", value.name, problem));
  };
  const Result<std::string> text = files.Read(value.name);
  if (!text) {
    return ErrorAt(value.location,
                   fmt::format("\"{}\" is not a named spectrum{} and cannot be read: {}", value.name,
                               DidYouMean(value.name, NamedSpectrumNames()), text.error().message));
  }
  if (text->size() > kSpectrumFileSizeMax) {
    return fail(fmt::format("{} bytes are more than the {} allowed", text->size(), kSpectrumFileSizeMax));
  }
  const Result<Samples> samples = ParseSamples(*text);
  if (!samples) return fail(samples.error().message);
  const std::string problem = SamplesProblem(samples->wavelengths, samples->values);
  if (!problem.empty()) return fail(problem);
  return FromTable(TableFromSamples(samples->wavelengths, samples->values), use);
}

}  // namespace

Result<Spectrum> MakeSpectrum(const SpectrumValue& value, SpectrumUse use, FileSource& files) {
  switch (value.form) {
    case SpectrumValue::Form::kRgb: return FromRgb(value, use);
    case SpectrumValue::Form::kBlackbody:
      if (!(value.kelvin > 0 && value.kelvin <= kKelvinMax)) {
        return ErrorAt(value.location,
                       fmt::format("temperature {} K is not between 0 and {} K", value.kelvin, kKelvinMax));
      }
      return FromTable(Blackbody(value.kelvin), use);
    case SpectrumValue::Form::kSamples: return FromSamples(value, use);
    case SpectrumValue::Form::kNamed: break;
  }
  if (std::shared_ptr<const DenseTable> table = NamedSpectrum(value.name))
    return FromTable(std::move(table), use);
  return FromFile(value, use, files);
}

}  // namespace tessera
