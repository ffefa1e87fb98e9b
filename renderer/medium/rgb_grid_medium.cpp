#include "renderer/medium/rgb_grid_medium.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "renderer/color/color_space.h"
#include "renderer/medium/medium_parameters.h"

namespace tessera {
namespace {

// As ColorSpace::ToSpectrum of an unbounded colour, but by the table, as for every texture lookup: there may
// be millions of voxels.
RgbVoxel VoxelOf(Rgb rgb, const ColorSpace& space) {
  const float largest = std::max({rgb.x, rgb.y, rgb.z});
  if (!(largest > 0)) return {};
  const float scale = 2 * largest;
  return {space.AlbedoPolynomialFast(rgb * (1 / scale)), scale};
}

// Remembers an error if a component is not in [0, kCoefficientMax]. Returns null if there is no such list or
// something is wrong with it.
std::shared_ptr<const RgbGrid> ReadRgbGrid(ParameterReader& reader, const char* name, const GridSize& size,
                                           std::shared_ptr<const DenseTable>* illuminant = nullptr) {
  if (!reader.Has(name)) return nullptr;
  const RgbList list = reader.Rgbs(name);
  const ColorSpace* const space = ColorSpace::Named(list.color_space);
  if (space == nullptr) {
    reader.FailAt(name, fmt::format("unknown colour space \"{}\"", list.color_space));
    return nullptr;
  }
  const uint64_t expected = uint64_t(size[0]) * uint64_t(size[1]) * uint64_t(size[2]);
  if (list.values.size() != expected) {
    reader.FailAt(name, fmt::format("{} has {} colours, expected nx * ny * nz = {} * {} * {} = {}", name,
                                    list.values.size(), size[0], size[1], size[2], expected));
    return nullptr;
  }
  auto grid = std::make_shared<RgbGrid>(size);
  size_t i = 0;
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      for (int x = 0; x < size[0]; ++x, ++i) {
        const Rgb rgb = list.values[i];
        for (int c = 0; c < 3; ++c) {
          if (rgb[c] >= 0 && rgb[c] <= kCoefficientMax) continue;
          reader.FailAt(name, fmt::format("{} has the component {} at ({}, {}, {}), expected 0 to 1e20", name,
                                          rgb[c], x, y, z));
          return nullptr;
        }
        grid->Set(x, y, z, VoxelOf(rgb, *space));
      }
    }
  }
  if (illuminant != nullptr) *illuminant = space->illuminant();
  return grid;
}

// Of a coefficient that may be missing.
MajorantGrid MajorantsOfCoefficient(const RgbGrid* grid, const GridSize& size) {
  if (grid != nullptr) return MajorantsOf(*grid, [](const RgbVoxel& voxel) { return voxel.Bound(); });
  return MajorantGrid(size, 1);
}

}  // namespace

float RgbVoxel::Bound() const {
  if (scale == 0) return 0;
  constexpr float kFirst = kLambdaMin, kLast = kLambdaMax;
  const auto at = [this](float lambda) {
    return (polynomial.c0 * lambda + polynomial.c1) * lambda + polynomial.c2;
  };
  float x = std::max(at(kFirst), at(kLast));
  const float turning = -polynomial.c1 / (2 * polynomial.c0);
  if (turning > kFirst && turning < kLast) x = std::max(x, at(turning));
  // Cancellation in the polynomial: its terms are much larger than their sum.
  constexpr float kRelativeError = 1e-6f;
  x += kRelativeError *
       ((std::abs(polynomial.c0) * kLast + std::abs(polynomial.c1)) * kLast + std::abs(polynomial.c2));
  const float sigmoid = 0.5f + x / (2 * std::sqrt(1 + x * x));
  return scale * std::min(sigmoid * (1 + kRelativeError), 1.0f);
}

RgbGridMedium RgbGridMedium::Read(ParameterReader& reader, const Transform& render_from_medium,
                                  FileSource& /*files*/, Diagnostics& /*diagnostics*/) {
  auto grid = std::make_shared<RgbGridContents>();
  const Bounds3 bounds = ReadGridBounds(reader, render_from_medium);
  const GridSize size = ReadGridSize(reader);
  grid->scale = ReadFactor(reader, "scale");
  grid->radiance_factor = ReadFactor(reader, "Lescale");
  if (!reader.Has("sigma_a") && !reader.Has("sigma_s")) reader.Fail("rgbgrid needs sigma_a or sigma_s");
  if (reader.Has("Le") && !reader.Has("sigma_a")) reader.FailAt("Le", "Le needs sigma_a");
  if (!reader.failed()) {
    grid->sigma_a = ReadRgbGrid(reader, "sigma_a", size);
    grid->sigma_s = ReadRgbGrid(reader, "sigma_s", size);
    grid->radiance = ReadRgbGrid(reader, "Le", size, &grid->illuminant);
    grid->sigma_max = MajorantsOfCoefficient(grid->sigma_a.get(), size);
    grid->sigma_max.Add(MajorantsOfCoefficient(grid->sigma_s.get(), size));
    if (!(grid->sigma_max.Max() * grid->scale <= kCoefficientMax))
      reader.FailAt("scale", "the coefficients are too large: at most 1e20 per scene unit");
    grid->placement = GridPlacement::Over(bounds, size, render_from_medium);
    CheckMeanFreePaths(grid->placement, grid->sigma_max.Max() * grid->scale, reader);
  }
  RgbGridMedium medium;
  medium.phase_ = PhaseFunction(ReadAsymmetry(reader));
  medium.grid_ = std::move(grid);
  return medium;
}

RgbGridCoefficients::RgbGridCoefficients(const RgbGridContents& grid, const SampledWavelengths& wavelengths)
    : grid_(&grid), wavelengths_(wavelengths.Followed()) {
  if (grid.radiance) illuminant_ = SampleTable(*grid.illuminant, wavelengths_) * grid.radiance_factor;
}

MediumPoint RgbGridCoefficients::PointAt(Point3 position) const {
  const auto sample = [this](const RgbVoxel& voxel) { return voxel.Sample(wavelengths_); };
  const auto at = [&](const std::shared_ptr<const RgbGrid>& grid) {
    return grid ? grid->Lookup(position, sample) : SampledSpectrum(1.0f);
  };
  MediumPoint point{at(grid_->sigma_a) * grid_->scale, at(grid_->sigma_s) * grid_->scale, SampledSpectrum()};
  if (grid_->radiance) point.emission = point.sigma_a * at(grid_->radiance) * illuminant_;
  return point;
}

}  // namespace tessera
