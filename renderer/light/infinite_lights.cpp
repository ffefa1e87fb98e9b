#include "renderer/light/infinite_lights.h"

#include "renderer/light/emission.h"
#include "renderer/light/environment_map.h"
#include "renderer/math/equal_area.h"
#include "renderer/shape/moved_sampling.h"

namespace tessera {
namespace {

// The mean of R, G and B of each texel.
std::vector<float> TexelMeans(const RgbImage& image, float* mean) {
  std::vector<float> values;
  values.reserve(static_cast<size_t>(image.width()) * static_cast<size_t>(image.height()));
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Rgb rgb = image.At(x, y);
      values.push_back((rgb.x + rgb.y + rgb.z) / 3);
      sum += values.back();
    }
  }
  *mean = static_cast<float>(sum / static_cast<double>(values.size()));
  return values;
}

}  // namespace

ConstantInfiniteLight ConstantInfiniteLight::Read(ParameterReader& reader, const LightContext& context) {
  ConstantInfiniteLight light{ReadEmission(reader, "L", context.files), context.samples_all};
  if (const auto illuminance = ReadTotal(reader, "illuminance"))
    light.L = light.L.Scaled(*illuminance * kInvPi);
  return light;
}

std::optional<LightSample> ConstantInfiniteLight::Sample(const LightQuery& query) const {
  if (!is_sampled) return std::nullopt;
  LightSample sample;
  sample.L = L.Sample(query.wavelengths);
  sample.wi = SampleUniformSphere(query.u);
  sample.pdf = kInv4Pi;
  sample.p = query.reference.p + sample.wi * (2 * query.scene_radius);
  return sample;
}

LightProfile ConstantInfiniteLight::Profile(float scene_radius) const {
  if (!is_sampled) return {false, 0, std::nullopt, 0};
  const float strength = Strength(L);
  return {true, 4 * kPi * kPi * Sqr(scene_radius) * strength, std::nullopt, kPi * strength};
}

ImageInfiniteLight ImageInfiniteLight::Read(ParameterReader& reader, const LightContext& context) {
  ImageInfiniteLight light;
  light.render_from_light = context.render_from_light;
  light.light_from_render = context.render_from_light.Inverse();
  light.keeps_angles = context.render_from_light.KeepsAngles();
  const RgbImage image = ReadEnvironmentMap(reader, context.images, context.diagnostics);
  float scale = ReadImageScale(reader, image.color_space());
  if (image.empty()) return light;
  scale *= IlluminanceFactor(reader, image);
  light.map = EmissionMap(image, scale);
  float mean = 0;
  std::vector<float> sampled = TexelMeans(image, &mean);
  if (!context.samples_all) {
    for (float& value : sampled) value = std::max(value - mean, 0.0f);
  }
  light.brighter =
      Distribution2D(sampled, static_cast<uint32_t>(image.width()), static_cast<uint32_t>(image.height()));
  const float white = Strength(Spectrum::Table(image.color_space().illuminant(), scale));
  light.mean_strength = mean * white;
  light.sampled_strength = light.brighter.mean() * white;
  return light;
}

Point2 ImageInfiniteLight::PlaceInMap(Vec3 d) const {
  return EqualAreaSphereToSquare(Normalize(light_from_render.ToVector(d)));
}

// The map has the area of the unit sphere, of which a transform that stretches makes other solid angles.
float ImageInfiniteLight::DensityRatio(Vec3 wi) const {
  return keeps_angles ? kInv4Pi : kInv4Pi * SolidAngleRatio(render_from_light, wi);
}

SampledSpectrum ImageInfiniteLight::Radiance(Point3, Vec3 d, const SampledWavelengths& wavelengths) const {
  return map.SampleNearest(PlaceInMap(d), wavelengths);
}

std::optional<LightSample> ImageInfiniteLight::Sample(const LightQuery& query) const {
  const Distribution2D::Drawn drawn = brighter.Sample(query.u);
  if (!(drawn.pdf > 0)) return std::nullopt;
  LightSample sample;
  sample.map = &map;
  sample.texel_x = drawn.x;
  sample.texel_y = drawn.y;
  sample.wi = Normalize(render_from_light.ToVector(EqualAreaSquareToSphere(drawn.p)));
  sample.pdf = drawn.pdf * DensityRatio(sample.wi);
  sample.p = query.reference.p + sample.wi * (2 * query.scene_radius);
  return sample;
}

float ImageInfiniteLight::Pdf(Point3, Vec3 wi) const {
  return brighter.Pdf(PlaceInMap(wi)) * DensityRatio(wi);
}

LightProfile ImageInfiniteLight::Profile(float scene_radius) const {
  return {true, 4 * kPi * kPi * Sqr(scene_radius) * mean_strength, std::nullopt, kPi * sampled_strength};
}

}  // namespace tessera
