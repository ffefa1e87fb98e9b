#include "renderer/integrator/integrator_kinds.h"

namespace tessera {
namespace {

constexpr IntegratorTraits kPath{IntegratorKind::kPath, false, true};
constexpr IntegratorTraits kVolPath{IntegratorKind::kVolPath, true, true};
constexpr IntegratorTraits kMixture{IntegratorKind::kMixture, true, false};
constexpr IntegratorTraits kSimplePath{IntegratorKind::kSimplePath, false, true};
constexpr IntegratorTraits kSimpleVolPath{IntegratorKind::kSimpleVolPath, true, false};
constexpr IntegratorTraits kRandomWalk{IntegratorKind::kRandomWalk, false, false};

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
