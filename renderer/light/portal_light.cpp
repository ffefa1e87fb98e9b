#include "renderer/light/portal_light.h"

#include <algorithm>
#include <cmath>

#include "renderer/color/named_spectra.h"
#include "renderer/color/spectrum_parameter.h"
#include "renderer/light/emission.h"
#include "renderer/light/environment_map.h"
#include "renderer/math/equal_area.h"
#include "renderer/texture/wrap_mode.h"

namespace tessera {
namespace {

// As in pbrt: by how much the cosines of the angles of a rectangle may be off.
constexpr float kAngleTolerance = 1e-3f;

// The solid angle per area of the map where the direction is (tan_x, tan_y, 1), not normalised.
float SolidAngle(float tan_x, float tan_y) {
  const float square = 1 + tan_x * tan_x + tan_y * tan_y;
  return kPi * kPi * ((1 + tan_x * tan_x) / square) * ((1 + tan_y * tan_y) / std::sqrt(square));
}

bool IsRectangle(const std::array<Point3, 4>& p) {
  const Vec3 p01 = Normalize(p[1] - p[0]), p12 = Normalize(p[2] - p[1]);
  const Vec3 p32 = Normalize(p[2] - p[3]), p03 = Normalize(p[3] - p[0]);
  const bool is_parallelogram =
      std::abs(Dot(p01, p32) - 1) <= kAngleTolerance && std::abs(Dot(p12, p03) - 1) <= kAngleTolerance;
  return is_parallelogram && std::abs(Dot(p01, p12)) <= kAngleTolerance &&
         std::abs(Dot(p32, p03)) <= kAngleTolerance;
}

Vec3 XyzOf(const Spectrum& spectrum) {
  double sum[3] = {};
  for (int i = 0; i < kLambdaCount; ++i) {
    const double value = spectrum.At(static_cast<float>(kLambdaMin + i));
    sum[0] += value * CieX()[static_cast<size_t>(i)];
    sum[1] += value * CieY()[static_cast<size_t>(i)];
    sum[2] += value * CieZ()[static_cast<size_t>(i)];
  }
  const auto normalised = [](double x) { return static_cast<float>(x / static_cast<double>(kCieYIntegral)); };
  return {normalised(sum[0]), normalised(sum[1]), normalised(sum[2])};
}

// An image of one texel: pbrt converts a radiance that comes in through a portal to sRGB.
RgbImage ConstantSky(ParameterReader& reader, const LightContext& context) {
  Rgb rgb{1, 1, 1};
  if (reader.Has("L")) {
    const Spectrum L =
        SpectrumParameter(reader, "L", SpectrumUse::kIlluminant, Spectrum::Constant(1), context.files);
    rgb = ColorSpace::Srgb().FromXyz(XyzOf(L));
    const bool is_rgb = std::ranges::any_of(reader.entity().parameters, [](const Parameter& parameter) {
      return parameter.name == "L" && parameter.type == "rgb";
    });
    if (!is_rgb) {
      context.diagnostics.Warn(reader.LocationOf("L"),
                               "light through a portal is stored as RGB: \"L\" is converted to sRGB");
    }
  }
  return RgbImage::OfOneColor(rgb);
}

RgbImage ReadSky(ParameterReader& reader, const LightContext& context) {
  if (reader.String("filename", "").empty()) return ConstantSky(reader, context);
  return ReadEnvironmentMap(reader, context.images, context.diagnostics);
}

Rgb BilinearOnSphere(const RgbImage& image, Point2 uv) {
  const float x = uv.x * static_cast<float>(image.width()) - 0.5f;
  const float y = uv.y * static_cast<float>(image.height()) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const auto at = [&](int texel_x, int texel_y) {
    Remap(texel_x, texel_y, image.width(), image.height(), WrapMode::kOctahedralSphere);
    return image.At(texel_x, texel_y);
  };
  const float dx = x - static_cast<float>(x0), dy = y - static_cast<float>(y0);
  return Lerp(dy, Lerp(dx, at(x0, y0), at(x0 + 1, y0)), Lerp(dx, at(x0, y0 + 1), at(x0 + 1, y0 + 1)));
}

}  // namespace

void PortalInfiniteLight::ReadPortal(ParameterReader& reader, const LightContext& context) {
  const std::vector<Point3> points = reader.Point3s("portal");
  if (points.size() != 4) {
    reader.FailAt("portal", "a portal has 4 corners, found " + std::to_string(points.size()));
    return;
  }
  std::array<Point3, 4> p;
  for (size_t i = 0; i < 4; ++i) p[i] = context.render_from_world.ToPoint(points[i]);
  const Vec3 side_x = p[3] - p[0], side_y = p[1] - p[0], normal = Cross(Normalize(side_x), side_y);
  area = Length(Cross(side_x, side_y));
  if (!(area > 0 && Length(normal) > 0 && std::isfinite(area) && std::isfinite(Length(p[2] - p[0])))) {
    reader.FailAt("portal", "the corners of the portal must span a rectangle");
    return;
  }
  if (!IsRectangle(p)) {
    context.diagnostics.Warn(reader.LocationOf("portal"),
                             "the portal is not a rectangle: one with its first and third corner is used");
  }
  frame = Frame::FromXZ(side_x, Normalize(normal));
  corner = p[0];
  opposite = p[2];
  for (const Point3 point : p) box.Add(point);
}

PortalInfiniteLight PortalInfiniteLight::Read(ParameterReader& reader, const LightContext& context) {
  PortalInfiniteLight light;
  light.ReadPortal(reader, context);
  const RgbImage sky = ReadSky(reader, context);
  float scale = ReadImageScale(reader, sky.color_space());
  if (sky.empty()) return light;
  scale *= IlluminanceFactor(reader, sky);
  if (reader.failed()) return light;
  const int size = sky.width();
  const Transform light_from_render = context.render_from_light.Inverse();
  std::vector<Rgb> texels;
  std::vector<float> weights;
  double radiance = 0, solid_angles = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      float solid_angle = 0;
      const Point2 uv{(static_cast<float>(x) + 0.5f) / static_cast<float>(size),
                      (static_cast<float>(y) + 0.5f) / static_cast<float>(size)};
      const Vec3 d = light_from_render.ToVector(light.DirectionAt(uv, &solid_angle));
      const Rgb rgb = BilinearOnSphere(sky, EqualAreaSphereToSquare(Normalize(d)));
      texels.push_back(rgb);
      weights.push_back((rgb.x + rgb.y + rgb.z) / 3 * solid_angle);
      radiance += weights.back();
      solid_angles += solid_angle;
    }
  }
  const auto count = static_cast<uint32_t>(size);
  light.distribution = WindowedDistribution2D(weights, count, count);
  light.map = EmissionMap(RgbImage::OfTexels(texels, size, sky.color_space()), scale);
  light.mean_strength = static_cast<float>(radiance / solid_angles) *
                        Strength(Spectrum::Table(sky.color_space().illuminant(), scale));
  return light;
}

Vec3 PortalInfiniteLight::DirectionAt(Point2 uv, float* solid_angle) const {
  const float x = std::tan((uv.x - 0.5f) * kPi), y = std::tan((uv.y - 0.5f) * kPi);
  *solid_angle = SolidAngle(x, y);
  return frame.FromLocal(Normalize(Vec3{x, y, 1}));
}

std::optional<Point2> PortalInfiniteLight::PlaceInMap(Vec3 d, float* solid_angle) const {
  const Vec3 w = frame.ToLocal(d);
  if (!(w.z > 0)) return std::nullopt;
  *solid_angle = SolidAngle(w.x / w.z, w.y / w.z);
  const auto place = [&](float along) {
    return std::clamp(std::atan2(along, w.z) * kInvPi + 0.5f, 0.0f, 1.0f);
  };
  return Point2{place(w.x), place(w.y)};
}

std::optional<PortalInfiniteLight::Window> PortalInfiniteLight::WindowFrom(Point3 p) const {
  float unused;
  const std::optional<Point2> a = PlaceInMap(corner - p, &unused), b = PlaceInMap(opposite - p, &unused);
  if (!a || !b) return std::nullopt;
  return Window{{std::min(a->x, b->x), std::min(a->y, b->y)}, {std::max(a->x, b->x), std::max(a->y, b->y)}};
}

SampledSpectrum PortalInfiniteLight::Radiance(Point3 from, Vec3 d,
                                              const SampledWavelengths& wavelengths) const {
  float unused;
  const std::optional<Window> window = WindowFrom(from);
  const std::optional<Point2> uv = PlaceInMap(d, &unused);
  if (!window || !uv) return SampledSpectrum();
  const bool is_inside =
      uv->x >= window->min.x && uv->x <= window->max.x && uv->y >= window->min.y && uv->y <= window->max.y;
  return is_inside ? map.SampleNearest(*uv, wavelengths) : SampledSpectrum();
}

std::optional<LightSample> PortalInfiniteLight::Sample(const LightQuery& query) const {
  const std::optional<Window> window = WindowFrom(query.reference.p);
  if (!window) return std::nullopt;
  const auto drawn = distribution.Sample(query.u, *window);
  if (!drawn) return std::nullopt;
  float solid_angle = 0;
  LightSample sample;
  sample.wi = DirectionAt(drawn->p, &solid_angle);
  sample.pdf = drawn->pdf / solid_angle;
  if (!(solid_angle > 0 && std::isfinite(sample.pdf))) return std::nullopt;
  sample.map = &map;
  sample.texel_x = drawn->x;
  sample.texel_y = drawn->y;
  sample.p = query.reference.p + sample.wi * (2 * query.scene_radius);
  return sample;
}

float PortalInfiniteLight::Pdf(Point3 from, Vec3 wi) const {
  float solid_angle = 0;
  const std::optional<Window> window = WindowFrom(from);
  const std::optional<Point2> uv = PlaceInMap(wi, &solid_angle);
  if (!window || !uv || !(solid_angle > 0)) return 0;
  const float pdf = distribution.Pdf(*uv, *window) / solid_angle;
  return std::isfinite(pdf) ? pdf : 0;
}

// The portal is chosen like a surface that emits the mean radiance.
LightProfile PortalInfiniteLight::Profile(float) const {
  LightBounds bounds;
  bounds.box = box;
  bounds.axis = -frame.z;
  bounds.cos_theta_o = 1;
  bounds.cos_theta_e = 0;
  bounds.strength = mean_strength * area;
  return {true, kPi * bounds.strength, bounds, 0};
}

}  // namespace tessera
