#include "renderer/medium/cloud_medium.h"

#include <algorithm>

#include "renderer/medium/medium_parameters.h"
#include "renderer/texture/noise.h"

namespace tessera {
namespace {

constexpr float kLacunarity = 1.99f;  // the zeros of the octaves do not coincide
constexpr float kRise = 4.5f;         // how quickly the noise gets dense below y = 1
constexpr int kOctaves = 5;
constexpr int kLayers = 32;  // of upper bounds

// The gradient of the noise, by differences.
Vec3 NoiseGradient(Point3 p) {
  constexpr float kDelta = 0.01f;
  const float here = Noise(p);
  const float x = Noise(p + Vec3{kDelta, 0, 0}), y = Noise(p + Vec3{0, kDelta, 0}),
              z = Noise(p + Vec3{0, 0, kDelta});
  return Vec3{x - here, y - here, z - here} / kDelta;
}

}  // namespace

float CloudShape::DensityAt(Point3 p) const {
  Point3 at = p * frequency;
  if (wispiness > 0) {
    float weight = 0.05f * wispiness, scale = 10;
    for (int octave = 0; octave < 2; ++octave) {
      at += NoiseGradient(at * scale) * weight;
      weight *= 0.5f;
      scale *= kLacunarity;
    }
  }
  float noise = 0, weight = 0.5f, scale = 1;
  for (int octave = 0; octave < kOctaves; ++octave) {
    noise += Noise(at * scale) * weight;
    weight *= 0.5f;
    scale *= kLacunarity;
  }
  const float wisps = std::clamp((1 - p.y) * kRise * density * noise, 0.0f, 1.0f);
  return std::clamp(wisps + 2 * std::max(0.0f, 0.5f - p.y), 0.0f, 1.0f);
}

// The absolute noise is at most 2 anywhere, as it interpolates sums of two offsets of at most 1, and its
// weights add up to less than 1.
float CloudShape::Bound(float y0, float y1) const {
  constexpr float kNoiseMax = 2, kRoundingErrors = 1 + 1e-4f;
  const float rise = std::max(std::abs(1 - y0), std::abs(1 - y1)) * kRise * density * kNoiseMax;
  const float base = 2 * std::max(0.0f, 0.5f - y0);
  return std::min(1.0f, (std::min(1.0f, rise) + base) * kRoundingErrors);
}

CloudMedium CloudMedium::Read(ParameterReader& reader, const Transform& render_from_medium, FileSource& files,
                              Diagnostics& /*diagnostics*/) {
  auto cloud = std::make_shared<CloudContents>();
  cloud->shape.density = ReadFactor(reader, "density");
  cloud->shape.wispiness = reader.Float("wispiness", 1);
  cloud->shape.frequency = reader.Float("frequency", 5);
  cloud->sigma_a = Tabulate(ReadCoefficient(reader, "sigma_a", files));
  cloud->sigma_s = Tabulate(ReadCoefficient(reader, "sigma_s", files));
  CheckCoefficients(cloud->sigma_a, 1, "sigma_a", reader);
  CheckCoefficients(cloud->sigma_s, 1, "sigma_s", reader);
  const Bounds3 bounds = ReadGridBounds(reader, render_from_medium);
  if (!reader.failed()) {
    // A grid of one column: position y + 0.5 is where layer y begins.
    const GridSize layers{1, kLayers, 1};
    cloud->placement = GridPlacement::Over(bounds, layers, render_from_medium);
    CheckMeanFreePaths(cloud->placement, LargestSum(cloud->sigma_a, cloud->sigma_s), reader);
    const Vec3 sides = bounds.Diagonal();
    cloud->per_position = {sides.x, sides.y / kLayers, sides.z};
    cloud->origin = bounds.min - cloud->per_position * 0.5f;
    cloud->density_max = MajorantGrid(layers);
    for (int y = 0; y <= kLayers; ++y) {
      const float y0 = cloud->origin.y + static_cast<float>(y) * cloud->per_position.y;
      const float bound = cloud->shape.Bound(y0, y0 + cloud->per_position.y);
      for (const int x : {0, 1}) {
        for (const int z : {0, 1}) cloud->density_max.Raise({x, y, z}, bound);
      }
    }
  }
  CloudMedium medium;
  medium.phase_ = PhaseFunction(ReadAsymmetry(reader));
  medium.cloud_ = std::move(cloud);
  return medium;
}

CloudCoefficients::CloudCoefficients(const CloudContents& cloud, const SampledWavelengths& wavelengths)
    : cloud_(&cloud) {
  const SampledWavelengths followed = wavelengths.Followed();
  sigma_a_ = SampleTable(cloud.sigma_a, followed);
  sigma_s_ = SampleTable(cloud.sigma_s, followed);
}

}  // namespace tessera
