#include "renderer/texture/texture_mapping.h"

#include <array>
#include <cmath>

#include "renderer/description/parameter_reader.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 4> kMappingNames{"uv", "spherical", "cylindrical", "planar"};

float Finite(float v) {
  return std::isfinite(v) ? v : 0;
}
Vec2 Finite(Vec2 v) {
  return {Finite(v.x), Finite(v.y)};
}

// `ds` and `dt` are the gradients of s and t in texture space.
TextureCoordinates2 FromGradients(Point2 st, Vec3 ds, Vec3 dt, const TextureCoordinates3& place) {
  return {st, {Dot(ds, place.dpdx), Dot(dt, place.dpdx)}, {Dot(ds, place.dpdy), Dot(dt, place.dpdy)}};
}

TextureCoordinates2 Spherical(const TextureCoordinates3& place) {
  const Point3 p = place.p;
  const float xy2 = p.x * p.x + p.y * p.y;
  const float xy = std::sqrt(xy2);
  const Vec3 dphi = Vec3{-p.y, p.x, 0} / (2 * kPi * xy2);
  const Vec3 dtheta = Vec3{p.x * p.z / xy, p.y * p.z / xy, -xy} / (kPi * (xy2 + p.z * p.z));
  const Vec3 w = Normalize(p);
  const float theta = std::acos(std::clamp(w.z, -1.0f, 1.0f));
  const float phi = std::atan2(w.y, w.x);
  // As in pbrt, s follows theta while its derivatives are those of phi, and the other way round for t.
  return FromGradients({theta * kInvPi, (phi < 0 ? phi + 2 * kPi : phi) * kInv2Pi}, dphi, dtheta, place);
}

TextureCoordinates2 Cylindrical(const TextureCoordinates3& place) {
  const Point3 p = place.p;
  const Vec3 dphi = Vec3{-p.y, p.x, 0} / (2 * kPi * (p.x * p.x + p.y * p.y));
  return FromGradients({(kPi + std::atan2(p.y, p.x)) * kInv2Pi, p.z}, dphi, {0, 0, 1}, place);
}

TextureCoordinates2 Uv(const TextureMapping& m, const TextureContext& c) {
  return {{m.scale.x * c.uv.x + m.offset.x, m.scale.y * c.uv.y + m.offset.y},
          {m.scale.x * c.dudx, m.scale.y * c.dvdx},
          {m.scale.x * c.dudy, m.scale.y * c.dvdy}};
}

}  // namespace

TextureCoordinates3 TextureMapping::Map3(const TextureContext& context) const {
  return {texture_from_render.ToPoint(context.p), texture_from_render.ToVector(context.dpdx),
          texture_from_render.ToVector(context.dpdy)};
}

TextureCoordinates2 TextureMapping::Map2(const TextureContext& context) const {
  TextureCoordinates2 c;
  switch (kind) {
    case Kind::kUv: c = Uv(*this, context); break;
    case Kind::kSpherical: c = Spherical(Map3(context)); break;
    case Kind::kCylindrical: c = Cylindrical(Map3(context)); break;
    case Kind::kPlanar: {
      const TextureCoordinates3 place = Map3(context);
      c = FromGradients({offset.x + Dot(place.p, s_axis), offset.y + Dot(place.p, t_axis)}, s_axis, t_axis,
                        place);
      break;
    }
    case Kind::kSpace: break;
  }
  return {Finite(c.st), Finite(c.dx), Finite(c.dy)};
}

TextureMapping ReadTextureMapping(ParameterReader& reader, const Transform& texture_from_render,
                                  Diagnostics& diagnostics) {
  TextureMapping m;
  m.texture_from_render = texture_from_render;
  const std::string kind = reader.ChoiceOrDefault("mapping", "uv", kMappingNames, diagnostics);
  if (kind == "spherical") {
    m.kind = TextureMapping::Kind::kSpherical;
  } else if (kind == "cylindrical") {
    m.kind = TextureMapping::Kind::kCylindrical;
  } else {
    m.offset = {reader.Float("udelta", 0), reader.Float("vdelta", 0)};
    if (kind == "planar") {
      m.kind = TextureMapping::Kind::kPlanar;
      m.s_axis = reader.Vector3Value("v1", {1, 0, 0});
      m.t_axis = reader.Vector3Value("v2", {0, 1, 0});
    } else {
      m.scale = {reader.Float("uscale", 1), reader.Float("vscale", 1)};
    }
  }
  return m;
}

TextureMapping SpaceMapping(const Transform& texture_from_render) {
  TextureMapping m;
  m.kind = TextureMapping::Kind::kSpace;
  m.texture_from_render = texture_from_render;
  return m;
}

}  // namespace tessera
