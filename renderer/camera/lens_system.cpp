#include "renderer/camera/lens_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderer/description/number_list.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr size_t kInterfaceValues = 4;
constexpr size_t kInterfacesMax = 256;  // zoom lenses have some 40
constexpr float kMetresPerMillimetre = 1e-3f;

// Lens files write 0 for the index of air.
float Index(float eta) {
  return eta > 0 ? eta : 1;
}

// The index on the side of the scene of interface i.
float IndexBefore(const std::vector<LensInterface>& interfaces, size_t i) {
  return i == 0 ? 1 : Index(interfaces[i - 1].eta);
}

// The distance at which a ray with unit direction meets a spherical interface on its way to the scene: the
// crossing of the sphere that lies nearer to the vertex at `vertex_z`.
std::optional<float> CrossSphere(Point3 o, Vec3 d, float curvature_radius, float vertex_z) {
  const Vec3 from_centre = o - Point3{0, 0, vertex_z - curvature_radius};
  const float along = Dot(from_centre, d);
  const Vec3 across = from_centre - d * along;
  const float discriminant = curvature_radius * curvature_radius - Dot(across, across);
  if (!(discriminant >= 0)) return std::nullopt;
  const float half = std::sqrt(discriminant);
  const float t = curvature_radius > 0 ? half - along : -half - along;
  if (!(t >= 0)) return std::nullopt;
  return t;
}

// Snell's law. n is a unit normal on the side of d's start, `eta_ratio` the index there over the one behind.
std::optional<Vec3> RefractAt(Vec3 d, Vec3 n, float eta_ratio) {
  const float cosine = -Dot(n, d);
  const float sine2 = eta_ratio * eta_ratio * std::max(0.0f, 1 - cosine * cosine);
  if (!(sine2 < 1)) return std::nullopt;
  return Normalize(d * eta_ratio + n * (eta_ratio * cosine - std::sqrt(1 - sine2)));
}

// A ray near the axis: its height, and its slope times the index of refraction.
struct ParaxialRay {
  double height = 1, slope = 0;
};

// Refraction by a power and transfer over a reduced distance (Smith 2000, "Modern Optical Engineering",
// section 3.2).
void Refract(ParaxialRay& ray, double power) {
  ray.slope -= ray.height * power;
}
void Transfer(ParaxialRay& ray, double thickness, double eta) {
  ray.height += ray.slope / eta * thickness;
}

// Of interface i for light from the scene.
double Power(const std::vector<LensInterface>& interfaces, size_t i) {
  const LensInterface& interface = interfaces[i];
  if (interface.curvature_radius == 0) return 0;
  return (static_cast<double>(Index(interface.eta)) - IndexBefore(interfaces, i)) /
         interface.curvature_radius;
}

}  // namespace

LensSystem::LensSystem(const std::vector<LensInterface>& interfaces) {
  TESSERA_CHECK(!interfaces.empty());
  float z = 0;
  for (size_t i = interfaces.size(); i-- > 0;) {
    const LensInterface& interface = interfaces[i];
    z += interface.thickness;
    surfaces_.push_back({interface.curvature_radius, z, interface.diameter / 2, Index(interface.eta),
                         IndexBefore(interfaces, i)});
  }
  rear_z_ = surfaces_.front().z;
  rear_radius_ = surfaces_.front().radius;
}

Result<std::vector<LensInterface>> LensSystem::ParseFile(const std::string& text) {
  const Result<std::vector<float>> numbers = ParseNumberList(text);
  if (!numbers) return numbers.error();
  if (numbers->empty() || numbers->size() % kInterfaceValues != 0) {
    return BadInput(
        fmt::format("has {} numbers, expected four for each interface: curvature radius, thickness,"
                    " index of refraction, aperture diameter",
                    numbers->size()));
  }
  if (numbers->size() / kInterfaceValues > kInterfacesMax)
    return BadInput(fmt::format("has more than {} interfaces", kInterfacesMax));
  std::vector<LensInterface> interfaces;
  for (size_t i = 0; i < numbers->size(); i += kInterfaceValues) {
    const float* values = numbers->data() + i;
    const std::string where = fmt::format("interface {}: ", i / kInterfaceValues + 1);
    if (!std::all_of(values, values + kInterfaceValues, [](float v) { return std::isfinite(v); }))
      return BadInput(where + "a number is not finite");
    if (values[2] < 0) return BadInput(where + "the index of refraction is negative");
    if (!(values[3] > 0)) return BadInput(where + "the aperture diameter is not above 0");
    interfaces.push_back({values[0] * kMetresPerMillimetre, values[1] * kMetresPerMillimetre, values[2],
                          values[3] * kMetresPerMillimetre});
  }
  return interfaces;
}

std::optional<CardinalPoints> LensSystem::FindCardinalPoints(const std::vector<LensInterface>& interfaces) {
  const size_t count = interfaces.size();
  ParaxialRay from_scene, from_film;
  double length = 0;  // from the first vertex to the last
  for (size_t i = 0; i < count; ++i) {
    Refract(from_scene, Power(interfaces, i));
    if (i + 1 == count) break;
    Transfer(from_scene, interfaces[i].thickness, Index(interfaces[i].eta));
    length += interfaces[i].thickness;
  }
  for (size_t i = count; i-- > 0;) {
    Refract(from_film, Power(interfaces, i));  // the same power from both sides
    if (i > 0) Transfer(from_film, interfaces[i - 1].thickness, Index(interfaces[i - 1].eta));
  }
  if (!(from_scene.slope < 0 && from_film.slope < 0)) return std::nullopt;
  CardinalPoints points;
  points.focal_length = -1 / from_scene.slope;
  if (!std::isfinite(points.focal_length)) return std::nullopt;
  // The focal point behind the last vertex, and the one before the first.
  const double film_focus = -from_scene.height / from_scene.slope;
  const double scene_focus = -from_film.height / from_film.slope;
  points.film_principal = points.focal_length - film_focus;
  points.scene_principal = length + scene_focus - points.focal_length;
  return points;
}

std::optional<double> LensSystem::FilmDistance(const CardinalPoints& lens, double distance) {
  // 1/f = 1/image + 1/object, where the two distances and that between the principal planes add up to
  // `distance`. Of the two solutions the one with the lens near the film.
  const double f = lens.focal_length;
  const double sum = distance - (lens.scene_principal - lens.film_principal);
  const double discriminant = sum * sum - 4 * f * sum;
  if (!(sum > 0 && discriminant >= 0)) return std::nullopt;
  // (sum - sqrt(discriminant)) / 2 without cancellation.
  const double image = 2 * f * sum / (sum + std::sqrt(discriminant));
  const double film_distance = image - lens.film_principal;
  if (!(film_distance > 0)) return std::nullopt;
  return film_distance;
}

std::optional<ParaxialPupil> LensSystem::FindParaxialPupil() const {
  const auto stop = std::ranges::find(surfaces_, 0.0f, &Surface::curvature_radius);
  if (stop == surfaces_.end()) return std::nullopt;
  // Rays from the centre and from the edge of the stop to the film.
  ParaxialRay centre{0, 1}, edge{1, 0};
  for (auto surface = stop; surface != surfaces_.begin();) {
    const Surface& from = *surface--;
    const double power =
        surface->curvature_radius == 0
            ? 0
            : (static_cast<double>(surface->eta_film) - surface->eta_scene) / surface->curvature_radius;
    for (ParaxialRay* ray : {&centre, &edge}) {
      Transfer(*ray, static_cast<double>(from.z) - surface->z, surface->eta_scene);
      Refract(*ray, power);
    }
  }
  // The image lies where rays from the centre cross the axis.
  const double behind = -centre.height / centre.slope;
  const double z = static_cast<double>(rear_z_) - behind;
  const double radius = (edge.height + edge.slope * behind) * stop->radius;
  if (!std::isfinite(z) || z == 0 || !std::isfinite(radius)) return std::nullopt;
  return ParaxialPupil{static_cast<float>(z), static_cast<float>(std::abs(radius))};
}

std::optional<CameraRay> LensSystem::Trace(Point3 o, Vec3 d, const Aperture& aperture) const {
  CameraRay ray{o, d};
  for (const Surface& surface : surfaces_) {
    if (!(ray.d.z > 0)) return std::nullopt;
    if (surface.curvature_radius == 0) {
      const float t = (surface.z - ray.o.z) / ray.d.z;
      if (!(t >= 0)) return std::nullopt;
      ray.o = ray.o + ray.d * t;
      ray.weight *= aperture.Transmittance({ray.o.x / surface.radius, ray.o.y / surface.radius});
      if (!(ray.weight > 0)) return std::nullopt;
      continue;
    }
    const std::optional<float> t = CrossSphere(ray.o, ray.d, surface.curvature_radius, surface.z);
    if (!t) return std::nullopt;
    ray.o = ray.o + ray.d * *t;
    if (!(Sqr(ray.o.x) + Sqr(ray.o.y) <= Sqr(surface.radius))) return std::nullopt;
    const Vec3 outward =
        (ray.o - Point3{0, 0, surface.z - surface.curvature_radius}) / std::abs(surface.curvature_radius);
    const std::optional<Vec3> refracted =
        RefractAt(ray.d, Dot(outward, ray.d) > 0 ? -outward : outward, surface.eta_film / surface.eta_scene);
    if (!refracted) return std::nullopt;
    ray.d = *refracted;
  }
  if (!(ray.d.z > 0)) return std::nullopt;
  return ray;
}

}  // namespace tessera
