#include "renderer/light/infinite_lights.h"

#include "renderer/light/emission.h"
#include "renderer/math/equal_area.h"

namespace tessera {
namespace {

// pbrt-v4's measure of the illuminance of the picture on a plane that faces +z: half of the true value. Used
// here too, so that scenes have the brightness that their authors saw.
float UpwardIlluminance(const RgbImage& image) {
  const float size = static_cast<float>(image.width());
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Vec3 w = EqualAreaSquareToSphere(
          {(static_cast<float>(x) + 0.5f) / size, (static_cast<float>(y) + 0.5f) / size});
      if (w.z > 0) sum += static_cast<double>(RelativeLuminance(image.color_space(), image.At(x, y))) * w.z;
    }
  }
  return static_cast<float>(sum) * (2 * kPi / (size * size));
}

// By how much the mean of R, G and B of each texel exceeds that of the picture; 0 where it does not.
std::vector<float> ExcessOverMean(const RgbImage& image, float* mean) {
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
  for (float& value : values) value = std::max(value - *mean, 0.0f);
  return values;
}

}  // namespace

ConstantInfiniteLight ConstantInfiniteLight::Read(ParameterReader& reader, const LightContext& context) {
  ConstantInfiniteLight light{ReadEmission(reader, "L", context.files)};
  if (const auto illuminance = ReadTotal(reader, "illuminance"))
    light.L = light.L.Scaled(*illuminance * kInvPi);
  return light;
}

std::optional<LightSample> ConstantInfiniteLight::Sample(const LightQuery&) const {
  return std::nullopt;
}

LightProfile ConstantInfiniteLight::Profile(float) const {
  return {false, 0, std::nullopt, 0};
}

ImageInfiniteLight ImageInfiniteLight::Read(ParameterReader& reader, const LightContext& context) {
  ImageInfiniteLight light;
  light.render_from_light = context.render_from_light;
  light.light_from_render = context.render_from_light.Inverse();
  const std::optional<float> illuminance = ReadTotal(reader, "illuminance");
  const RgbImage image = RgbImage::Read(reader, context.images, context.diagnostics);
  float scale = ReadImageScale(reader, image.color_space());
  if (image.empty()) return light;
  if (image.width() != image.height()) {
    reader.FailAt("filename",
                  "the image is not square; environment maps must be equal-area octahedral (pbrt's imgtool "
                  "makeequiarea converts them)");
    return light;
  }
  if (illuminance) {
    const float unit = UpwardIlluminance(image);
    if (unit > 0)
      scale *= *illuminance / unit;
    else
      reader.FailAt("illuminance", "\"illuminance\" cannot be reached: the upper half of the image is black");
  }
  light.map = EmissionMap(image, scale);
  float mean = 0;
  const std::vector<float> excess = ExcessOverMean(image, &mean);
  light.brighter =
      Distribution2D(excess, static_cast<uint32_t>(image.width()), static_cast<uint32_t>(image.height()));
  const float white = Strength(Spectrum::Table(image.color_space().illuminant(), scale));
  light.mean_strength = mean * white;
  light.sampled_strength = light.brighter.mean() * white;
  return light;
}

Point2 ImageInfiniteLight::PlaceInMap(Vec3 d) const {
  return EqualAreaSphereToSquare(Normalize(light_from_render.ToVector(d)));
}

SampledSpectrum ImageInfiniteLight::Radiance(Vec3 d, const SampledWavelengths& wavelengths) const {
  return map.SampleNearest(PlaceInMap(d), wavelengths);
}

std::optional<LightSample> ImageInfiniteLight::Sample(const LightQuery& query) const {
  const Distribution2D::Drawn drawn = brighter.Sample(query.u);
  if (!(drawn.pdf > 0)) return std::nullopt;
  LightSample sample;
  sample.L = map.Sample(drawn.x, drawn.y, query.wavelengths);
  sample.wi = Normalize(render_from_light.ToVector(EqualAreaSquareToSphere(drawn.p)));
  sample.pdf = drawn.pdf * kInv4Pi;
  sample.p = query.reference.p + sample.wi * (2 * query.scene_radius);
  return sample;
}

float ImageInfiniteLight::Pdf(Vec3 wi) const {
  return brighter.Pdf(PlaceInMap(wi)) * kInv4Pi;
}

LightProfile ImageInfiniteLight::Profile(float scene_radius) const {
  return {true, 4 * kPi * kPi * Sqr(scene_radius) * mean_strength, std::nullopt, kPi * sampled_strength};
}

}  // namespace tessera
