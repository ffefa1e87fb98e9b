#include "renderer/integrator/integrator_kinds.h"

namespace tessera {
namespace {

constexpr IntegratorTraits kPath{.kind = IntegratorKind::kPath, .has_shadow_rays = true};
constexpr IntegratorTraits kVolPath{
    .kind = IntegratorKind::kVolPath, .follows_media = true, .has_shadow_rays = true, .has_subsurface = true};
constexpr IntegratorTraits kMixture{
    .kind = IntegratorKind::kMixture, .follows_media = true, .draws_rays_to_lights = true};
constexpr IntegratorTraits kSimplePath{.kind = IntegratorKind::kSimplePath, .has_shadow_rays = true};
constexpr IntegratorTraits kSimpleVolPath{.kind = IntegratorKind::kSimpleVolPath, .follows_media = true};
constexpr IntegratorTraits kRandomWalk{.kind = IntegratorKind::kRandomWalk};

constexpr Kind<IntegratorTraits> kIntegrators[] = {
    {"path", Support::kSupported, kPath},
    {"volpath", Support::kSupported, kVolPath},
    {"mixture", Support::kSupported, kMixture},
    {"simplepath", Support::kSupported, kSimplePath},
    {"simplevolpath", Support::kSupported, kSimpleVolPath},
    {"randomwalk", Support::kSupported, kRandomWalk},
    // Other estimators of the same picture.
    {"bdpt", Support::kMapped, kVolPath, "volpath"},
    {"lightpath", Support::kMapped, kVolPath, "volpath"},
    {"mlt", Support::kMapped, kVolPath, "volpath"},
    {"sppm", Support::kMapped, kVolPath, "volpath"},
    // Not of radiance: another picture.
    {"ambientocclusion", Support::kMapped, kVolPath, "volpath"},
    {"function", Support::kMapped, kVolPath, "volpath"},
};

}  // namespace

KindTable<IntegratorTraits> Integrators() {
  return {"integrator", kIntegrators};
}

}  // namespace tessera
