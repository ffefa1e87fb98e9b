#include "renderer/medium/grid_medium.h"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "renderer/color/named_spectra.h"
#include "renderer/medium/medium_parameters.h"

namespace tessera {
namespace {

constexpr float kKelvinMin = 100;  // colder bodies emit nothing that is visible

// A grid from the list `name`, or null if there is none. Remembers an error if it has another number of
// values or one of them is not finite or, unless `may_be_negative`, negative.
std::shared_ptr<const FloatGrid> ReadGrid(ParameterReader& reader, const char* name, const GridSize& size,
                                          bool may_be_negative = false) {
  if (!reader.Has(name)) return nullptr;
  const std::vector<float> values = reader.Floats(name);
  const uint64_t expected = uint64_t(size[0]) * uint64_t(size[1]) * uint64_t(size[2]);
  if (values.size() != expected) {
    reader.FailAt(name, fmt::format("{} has {} values, expected nx * ny * nz = {} * {} * {} = {}", name,
                                    values.size(), size[0], size[1], size[2], expected));
    return nullptr;
  }
  auto grid = std::make_shared<FloatGrid>(size);
  size_t i = 0;
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      for (int x = 0; x < size[0]; ++x, ++i) {
        const float value = values[i];
        if (!std::isfinite(value) || (value < 0 && !may_be_negative)) {
          reader.FailAt(name, fmt::format("{} has the value {} at ({}, {}, {}), expected a finite number{}",
                                          name, value, x, y, z, may_be_negative ? "" : " of at least 0"));
          return nullptr;
        }
        grid->Set(x, y, z, value);
      }
    }
  }
  return grid;
}

void ReadEmission(ParameterReader& reader, FileSource& files, const GridSize& size, GridContents& grid) {
  grid.temperature = ReadGrid(reader, "temperature", size, true);
  if (grid.temperature && reader.Has("Le")) reader.FailAt("Le", "Le and temperature exclude each other");
  grid.temperature_scale = TemperatureScale::Read(reader);
  const Spectrum radiance = ReadRadiance(reader, files, 1);
  grid.radiance = Tabulate(radiance);
  grid.radiance_scale = ReadGrid(reader, "Lescale", size);
  grid.is_emissive = grid.temperature != nullptr || radiance.MaxValue() > 0;
}

SampledSpectrum BlackbodyAt(float kelvin, SampledSpectrum lambda) {
  SampledSpectrum value;
  for (int i = 0; i < 4; ++i) value.Set(i, BlackbodyValue(kelvin, lambda[i]));
  return value;
}

}  // namespace

TemperatureScale TemperatureScale::Read(ParameterReader& reader) {
  TemperatureScale result;
  const float cutoff = reader.Float("temperaturecutoff", 0);
  result.offset = reader.Float("temperatureoffset", cutoff);
  result.scale = reader.Float("temperaturescale", 1);
  return result;
}

void ReadGridCoefficients(ParameterReader& reader, FileSource& files, GridContents& grid) {
  const Spectrum sigma_a = ReadCoefficient(reader, "sigma_a", files);
  const Spectrum sigma_s = ReadCoefficient(reader, "sigma_s", files);
  const float scale = ReadFactor(reader, "scale");
  grid.sigma_a = Tabulate(sigma_a.Scaled(scale));
  grid.sigma_s = Tabulate(sigma_s.Scaled(scale));
  const float density = std::max(grid.density_max.Max(), 1.0f);
  CheckCoefficients(grid.sigma_a, density, "sigma_a", reader);
  CheckCoefficients(grid.sigma_s, density, "sigma_s", reader);
  CheckMeanFreePaths(grid.placement, LargestSum(grid.sigma_a, grid.sigma_s) * grid.density_max.Max(), reader);
}

UniformGridMedium UniformGridMedium::Read(ParameterReader& reader, const Transform& render_from_medium,
                                          FileSource& files, Diagnostics& /*diagnostics*/) {
  auto grid = std::make_shared<GridContents>();
  const Bounds3 bounds = ReadGridBounds(reader, render_from_medium);
  const GridSize size = ReadGridSize(reader);
  if (!reader.Has("density")) reader.Fail("uniformgrid needs a density");
  if (!reader.failed()) grid->density = ReadGrid(reader, "density", size);
  if (!grid->density) grid->density = std::make_shared<FloatGrid>(GridSize{1, 1, 1});
  grid->density_max = MajorantsOf(*grid->density, [](float density) { return density; });
  if (!reader.failed()) grid->placement = GridPlacement::Over(bounds, size, render_from_medium);
  ReadGridCoefficients(reader, files, *grid);
  if (!reader.failed()) ReadEmission(reader, files, size, *grid);
  UniformGridMedium medium;
  medium.phase_ = PhaseFunction(ReadAsymmetry(reader));
  medium.grid_ = std::move(grid);
  return medium;
}

GridCoefficients::GridCoefficients(const GridContents& grid, const SampledWavelengths& wavelengths)
    : grid_(&grid) {
  const SampledWavelengths followed = wavelengths.Followed();
  lambda_ = followed.lambda;
  sigma_a_ = SampleTable(grid.sigma_a, followed);
  sigma_s_ = SampleTable(grid.sigma_s, followed);
  if (grid.is_emissive) radiance_ = SampleTable(grid.radiance, followed);
}

SampledSpectrum GridCoefficients::RadianceAt(Point3 position) const {
  float factor = grid_->radiance_factor;
  if (grid_->radiance_scale) factor *= grid_->radiance_scale->Lookup(position);
  if (!(factor > 0)) return SampledSpectrum();
  if (!grid_->temperature) return radiance_ * factor;
  const TemperatureScale& scale = grid_->temperature_scale;
  const float kelvin = (grid_->temperature->Lookup(position) - scale.offset) * scale.scale;
  if (!(kelvin > kKelvinMin)) return SampledSpectrum();
  return BlackbodyAt(kelvin, lambda_) * factor;
}

}  // namespace tessera
