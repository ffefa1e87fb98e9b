#include "renderer/accelerator/alpha_test.h"

#include <bit>

#include "renderer/shape/shape_interaction.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

uint64_t Bits(float a, float b) {
  return uint64_t{std::bit_cast<uint32_t>(a)} << 32 | std::bit_cast<uint32_t>(b);
}

}  // namespace

bool AlphaIsHit(const Geometry& geometry, const TextureTable& textures, const Ray& ray,
                const FloatInput& alpha, const Hit& hit) {
  float value = alpha.constant;
  if (!alpha.IsConstant()) {
    const HitPoint point = MakeHitPoint(geometry, hit, ray);
    TextureContext lookup{};
    lookup.p = point.p;
    lookup.n = point.n;
    lookup.uv = point.uv;
    value = textures.Evaluate(alpha, lookup);
  }
  if (value >= 1) return true;
  if (!(value > 0)) return false;
  const auto& [o, d, t_max, time] = ray;
  const uint64_t hash = Hash(Bits(o.x, o.y), Bits(o.z, d.x), Bits(d.y, d.z), hit.instance);
  return UniformFloat(static_cast<uint32_t>(hash >> 32)) < value;
}

}  // namespace tessera
