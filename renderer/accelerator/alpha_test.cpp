#include "renderer/accelerator/alpha_test.h"

#include "renderer/math/random_stream.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {
bool AlphaIsHit(const Geometry& geometry, const TextureTable& textures, const Ray& ray,
                const FloatInput& alpha, const Hit& hit, int crossing) {
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
  const uint64_t hash = ExtendHash(Hash(ray.o, ray.d), hit.instance, hit.shape, hit.primitive, crossing);
  return UniformFloatFromHash(hash) < value;
}

}  // namespace tessera
