#include "renderer/material/relief.h"

#include <cmath>

namespace tessera {
namespace {

constexpr float kShiftDefault = 0.0005f;  // in u or v, where the footprint is not known

// Leaves the geometry as it was where the tangents give no normal.
void SetTangents(Vec3 dpdu, Vec3 dpdv, SurfaceInteraction& interaction) {
  const Vec3 cross = Cross(dpdu, dpdv);
  const float length = Length(cross);
  if (!(length > 0) || !std::isfinite(length)) return;
  interaction.shading.n = FaceForward(cross / length, interaction.n);
  interaction.shading.dpdu = dpdu;
  interaction.shading.dpdv = dpdv;
}

float Shift(float per_x, float per_y) {
  const float shift = 0.5f * (std::abs(per_x) + std::abs(per_y));
  return shift > 0 && std::isfinite(shift) ? shift : kShiftDefault;
}

}  // namespace

void ApplyBumpMap(const FloatInput& displacement, const TextureTable& textures, const TextureContext& context,
                  SurfaceInteraction& interaction) {
  const SurfaceInteraction::Shading& shading = interaction.shading;
  const float du = Shift(context.dudx, context.dudy), dv = Shift(context.dvdx, context.dvdy);
  TextureContext shifted = context;
  shifted.p = context.p + shading.dpdu * du;
  shifted.uv = context.uv + Vec2{du, 0};
  const float at_u = textures.Evaluate(displacement, shifted);
  shifted.p = context.p + shading.dpdv * dv;
  shifted.uv = context.uv + Vec2{0, dv};
  const float at_v = textures.Evaluate(displacement, shifted);
  const float here = textures.Evaluate(displacement, context);
  const Vec3 dpdu = shading.dpdu + shading.n * ((at_u - here) / du) + shading.dndu * here;
  const Vec3 dpdv = shading.dpdv + shading.n * ((at_v - here) / dv) + shading.dndv * here;
  SetTangents(dpdu, dpdv, interaction);
}

void ApplyNormalMap(const NormalMap& map, SurfaceInteraction& interaction) {
  const SurfaceInteraction::Shading& shading = interaction.shading;
  const Vec3 n = Frame::FromXZ(shading.dpdu, shading.n).FromLocal(map.Lookup(interaction.uv));
  const Frame frame = Frame::FromXZ(shading.dpdu, n);
  SetTangents(frame.x * Length(shading.dpdu), frame.y * Length(shading.dpdv), interaction);
}

}  // namespace tessera
