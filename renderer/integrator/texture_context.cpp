#include "renderer/integrator/texture_context.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr float kDerivativeMax = 1e8f;  // per pixel: keeps products of derivatives finite

float Clamped(float v) {
  return std::isfinite(v) ? std::clamp(v, -kDerivativeMax, kDerivativeMax) : 0;
}

}  // namespace

TextureContext MakeTextureContext(const SurfaceInteraction& interaction, const Camera& camera, float scale) {
  TextureContext context = PlaceOf(interaction);
  const Footprint footprint = camera.ApproximateFootprint(interaction.p, interaction.n, scale);
  context.dpdx = footprint.dpdx;
  context.dpdy = footprint.dpdy;
  // Least squares for (du, dv) in dpdu du + dpdv dv = dpdx, and the same for y.
  const Vec3 u = interaction.dpdu, v = interaction.dpdv;
  const float uu = Dot(u, u), uv = Dot(u, v), vv = Dot(v, v);
  const float inverse = 1 / DifferenceOfProducts(uu, vv, uv, uv);
  const float ux = Dot(u, footprint.dpdx), vx = Dot(v, footprint.dpdx);
  const float uy = Dot(u, footprint.dpdy), vy = Dot(v, footprint.dpdy);
  context.dudx = Clamped(DifferenceOfProducts(vv, ux, uv, vx) * inverse);
  context.dvdx = Clamped(DifferenceOfProducts(uu, vx, uv, ux) * inverse);
  context.dudy = Clamped(DifferenceOfProducts(vv, uy, uv, vy) * inverse);
  context.dvdy = Clamped(DifferenceOfProducts(uu, vy, uv, uy) * inverse);
  return context;
}

}  // namespace tessera
