#include "renderer/light/projector_lights.h"

#include <algorithm>

#include "renderer/light/emission.h"
#include "renderer/math/equal_area.h"

namespace tessera {
namespace {

// Cosine: flatter directions count as behind the projector.
constexpr float kNearPlane = 1e-3f;

Transform SwapYAndZ() {
  Matrix4 m;
  m.m = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}}};
  return {m, m};
}

// The channels that make up the intensity: Y, or R, G and B averaged, as in pbrt whatever their colour space.
// Empty after an error.
std::vector<int> IntensityChannels(ParameterReader& reader, const Image& image, const std::string& name) {
  const int y = image.ChannelIndex("Y");
  const std::optional<std::array<int, 3>> rgb = image.RgbChannels();
  if (rgb.has_value() == (y >= 0)) {
    reader.FailAt("filename", "\"" + name + "\" must have either a Y channel or R, G and B channels");
    return {};
  }
  if (rgb) return {rgb->begin(), rgb->end()};
  return {y};
}

bool IsIesName(std::string_view name) {
  constexpr std::string_view kEnding = ".ies";
  return name.size() >= kEnding.size() &&
         std::ranges::equal(name.substr(name.size() - kEnding.size()), kEnding,
                            [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

IesProfile ReadProfile(ParameterReader& reader, FileSource& files, const std::string& name) {
  const Result<std::string> text = files.Read(name);
  if (!text) {
    reader.FailAt("filename", text.error().message);
    return {};
  }
  Result<IesProfile> profile = IesProfile::Read(*text);
  if (profile) return std::move(*profile);
  reader.FailAt("filename", name + ": " + profile.error().message);
  return {};
}

// The square map of parameter `filename` and its size.
std::vector<float> ReadMap(ParameterReader& reader, ImageCache& images, const std::string& name, int* size) {
  const Result<std::shared_ptr<const Image>> read = images.Get(name, std::nullopt);
  if (!read) {
    reader.FailAt("filename", read.error().message);
    return {};
  }
  const Image& image = **read;
  if (image.width != image.height) {
    reader.FailAt("filename",
                  "\"" + name + "\" is not square; goniometric maps must be equal-area octahedral");
    return {};
  }
  const std::vector<int> channels = IntensityChannels(reader, image, name);
  for (const int channel : channels) {
    if (IsFinite(image, channel)) continue;
    reader.FailAt("filename", "\"" + name + "\" contains infinite or NaN values, which a light cannot emit");
    return {};
  }
  if (channels.empty()) return {};
  *size = image.width;
  std::vector<float> map;
  map.reserve(static_cast<size_t>(image.width) * image.width);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      float sum = 0;
      for (const int channel : channels) sum += image.Get(x, y, channel);
      map.push_back(std::clamp(sum / static_cast<float>(channels.size()), 0.0f, kEmissionMax));
    }
  }
  return map;
}

}  // namespace

GoniometricLight GoniometricLight::Read(ParameterReader& reader, const LightContext& context) {
  GoniometricLight light{LightPlace(context.render_from_light * SwapYAndZ()),
                         ReadEmission(reader, "I", context.files),
                         {},
                         0,
                         {},
                         0};
  const std::string name = reader.String("filename", "");
  if (name.empty()) {
    reader.Fail("a goniometric light requires \"filename\"");
  } else if (IsIesName(name)) {
    light.profile = ReadProfile(reader, context.files, name);
    if (!light.profile.empty()) light.mean = light.profile.Mean();
  } else {
    light.map = ReadMap(reader, context.images, name, &light.size);
    double sum = 0;
    for (const float value : light.map) sum += value;
    if (!light.map.empty()) light.mean = static_cast<float>(sum / static_cast<double>(light.map.size()));
  }
  if (const auto power = ReadTotal(reader, "power")) {
    if (light.mean > 0)
      light.I = light.I.Scaled(*power * kInv4Pi / light.mean);
    else
      reader.FailAt("power", "\"power\" cannot be reached: the image is black");
  }
  return light;
}

float GoniometricLight::Factor(Vec3 d) const {
  if (!profile.empty()) return profile.Intensity(d);
  const Point2 uv = EqualAreaSphereToSquare(d);
  const int x = std::min(static_cast<int>(uv.x * static_cast<float>(size)), size - 1);
  const int y = std::min(static_cast<int>(uv.y * static_cast<float>(size)), size - 1);
  return map[static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x)];
}

std::optional<LightSample> GoniometricLight::Sample(const LightQuery& query) const {
  std::optional<LightSample> sample = SamplePoint(place.p, query.reference);
  if (!sample) return std::nullopt;
  const float factor = Factor(place.Outgoing(sample->wi));
  if (factor == 0) return std::nullopt;
  sample->L *= factor * I.Sample(query.wavelengths);
  return sample;
}

LightProfile GoniometricLight::Profile(float) const {
  LightBounds bounds;
  bounds.box = {place.p, place.p};
  bounds.AddAllDirections();
  bounds.strength = Strength(I) * std::abs(mean);
  return {true, 4 * kPi * bounds.strength, bounds, 0};
}

template <typename Value>
float ProjectionLight::SolidAngleMean(int width_px, int height_px, const Value& value) const {
  double sum = 0;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const float px = (2 * (static_cast<float>(x) + 0.5f) / static_cast<float>(width_px) - 1) * width;
      const float py = (2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(height_px) - 1) * height;
      const float cosine = 1 / std::sqrt(1 + Sqr(tan_half_fov) * (px * px + py * py));
      sum += static_cast<double>(value(x, y)) * (cosine * cosine * cosine);
    }
  }
  return static_cast<float>(sum / (static_cast<double>(width_px) * height_px));
}

ProjectionLight ProjectionLight::Read(ParameterReader& reader, const LightContext& context) {
  const Transform from_light = context.render_from_light * Scale(1, -1, 1);  // rows of pictures run downwards
  ProjectionLight light{LightPlace(from_light), Normalize(from_light.ToVector({0, 0, 1})), {}};
  const float fov = reader.Float("fov", 90);
  if (!(fov > 0 && fov < 180)) reader.FailAt("fov", "\"fov\" must be between 0 and 180 degrees");
  const std::optional<float> power = ReadTotal(reader, "power");
  if (!reader.Has("filename")) reader.Fail("a projection light requires \"filename\"");
  if (reader.failed()) return light;
  const RgbImage image = RgbImage::Read(reader, context.images, context.diagnostics);
  float scale = ReadImageScale(reader, image.color_space());
  if (image.empty()) return light;
  const float aspect = static_cast<float>(image.width()) / static_cast<float>(image.height());
  light.tan_half_fov = std::tan(Radians(fov) / 2);
  light.width = std::max(aspect, 1.0f);
  light.height = std::max(1 / aspect, 1.0f);
  const float luminance = light.SolidAngleMean(image.width(), image.height(), [&](int x, int y) {
    return RelativeLuminance(image.color_space(), image.At(x, y));
  });
  const float unit_power = light.PlaneArea() * luminance;
  if (power && unit_power > 0) scale *= *power / unit_power;
  if (power && !(unit_power > 0)) reader.FailAt("power", "\"power\" cannot be reached: the image is black");
  light.map = EmissionMap(image, scale);
  const float white = Strength(Spectrum::Table(image.color_space().illuminant(), scale));
  light.power = white * unit_power;
  const Rgb mean = image.Mean();
  light.strength = white * (mean.x + mean.y + mean.z) / 3;
  return light;
}

std::optional<LightSample> ProjectionLight::Sample(const LightQuery& query) const {
  std::optional<LightSample> sample = SamplePoint(place.p, query.reference);
  if (!sample) return std::nullopt;
  const Vec3 w = place.Outgoing(sample->wi);
  if (w.z < kNearPlane) return std::nullopt;
  const float x = w.x / (w.z * tan_half_fov), y = w.y / (w.z * tan_half_fov);
  if (std::abs(x) > width || std::abs(y) > height) return std::nullopt;
  const Point2 uv{(x / width + 1) / 2, (y / height + 1) / 2};
  const SampledSpectrum I = map.SampleNearest(uv, query.wavelengths);
  if (!AnyNonZero(I)) return std::nullopt;
  sample->L *= I;
  return sample;
}

LightProfile ProjectionLight::Profile(float) const {
  // Against rounding in the corners, where only samples of this light find it.
  constexpr float kRimSlack = 1e-3f;
  LightBounds bounds;
  bounds.box = {place.p, place.p};
  bounds.axis = axis;
  bounds.cos_theta_e = 1 / std::sqrt(1 + Sqr(tan_half_fov) * (width * width + height * height)) - kRimSlack;
  if (!place.keeps_angles || bounds.cos_theta_e < 0) bounds.AddAllDirections();
  bounds.strength = strength;
  return {true, power, bounds, 0};
}

}  // namespace tessera
