#include "renderer/camera/spherical_camera.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/camera/thin_lens.h"
#include "renderer/math/equal_area.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 2> kMappings = {"equalarea", "equirectangular"};

// A filter reaches beyond the edges of the picture. There the unfolded octahedron goes on at the same edge,
// mirrored about its middle.
Point2 WrapOctahedral(Point2 p) {
  if (p.x < 0 || p.x > 1) p = {p.x < 0 ? -p.x : 2 - p.x, 1 - p.y};
  if (p.y < 0 || p.y > 1) p = {1 - p.x, p.y < 0 ? -p.y : 2 - p.y};
  return {std::clamp(p.x, 0.0f, 1.0f), std::clamp(p.y, 0.0f, 1.0f)};
}

}  // namespace

SphericalCamera SphericalCamera::Read(const CameraDirective& directive) {
  SphericalCamera camera;
  // pbrt's parameters of the other cameras, which have no effect here.
  constexpr float kNoFocus = 1e30f;
  ThinLens::Read(directive.reader, kNoFocus);
  ReadScreenWindow(directive);
  if (directive.reader.Choice("mapping", kMappings[0], kMappings) == kMappings[1])
    camera.mapping_ = Mapping::kEquirectangular;
  camera.width_ = static_cast<float>(directive.film.width);
  camera.height_ = static_cast<float>(directive.film.height);
  return camera;
}

CameraRay SphericalCamera::GenerateRay(Point2 film, Point2) const {
  const Point2 p{film.x / width_, film.y / height_};
  switch (mapping_) {
    case Mapping::kEqualArea: {
      const Vec3 d = EqualAreaSquareToSphere(WrapOctahedral(p));
      return {{0, 0, 0}, {d.x, d.z, d.y}};
    }
    case Mapping::kEquirectangular: break;
  }
  const float theta = kPi * p.y, phi = 2 * kPi * p.x;
  const float sin_theta = std::sin(theta);
  return {{0, 0, 0}, {sin_theta * std::cos(phi), std::cos(theta), sin_theta * std::sin(phi)}};
}

}  // namespace tessera
