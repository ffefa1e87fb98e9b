#include "renderer/integrator/subsurface_probe.h"

#include <bit>

#include "renderer/integrator/path_vertex.h"
#include "renderer/shape/shape_interaction.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

// Crossings of one probe. Those of a ray that is caught in rounding errors have an end.
constexpr int kProbeHitsMax = 1000;

struct Found {
  SurfaceInteraction interaction;  // one of them, each with the same probability
  int count = 0;
};

Found SurfacesAlong(const PathContext& context, const ProbeSegment& probe, const SurfaceInteraction& entry,
                    float u) {
  const uint64_t seed = std::bit_cast<uint32_t>(u);
  const Point3 end = probe.from + probe.along;
  Found found;
  Point3 from = probe.from;
  for (int i = 0; i < kProbeHitsMax; ++i) {
    const Vec3 rest = end - from;
    if (!(Dot(rest, probe.along) > 0)) break;
    const float distance = Length(rest);
    const Ray ray{from, rest / distance, distance, entry.time};
    ++context.counts.bounce;
    Hit hit;
    if (!context.world.accelerator->Intersect(ray, &hit)) break;
    const SurfaceInteraction at = MakeInteraction(context.world.geometry, hit, ray);
    if (at.material == entry.material) {
      ++found.count;
      const float choice = UniformFloatFromHash(Hash(seed, static_cast<uint64_t>(found.count)));
      if (choice * static_cast<float>(found.count) < 1) found.interaction = at;
    }
    from = OffsetRayOrigin(at.p, at.p_error, at.n, ray.d);
  }
  return found;
}

}  // namespace

std::optional<SubsurfaceExit> SampleSubsurface(const PathContext& context, const SurfaceInteraction& entry,
                                               bool* is_subsurface) {
  const std::optional<Subsurface> below = SubsurfaceAt(context, entry);
  *is_subsurface = below.has_value();
  if (!below) return std::nullopt;
  const float u_axis = context.sampler.Get1D();
  const Point2 u_radius = context.sampler.Get2D();
  const float u_choice = context.sampler.Get1D();
  const std::optional<ProbeSegment> probe = below->bssrdf.SampleProbe(u_axis, u_radius);
  if (!probe) return std::nullopt;
  const Found found = SurfacesAlong(context, *probe, entry, u_choice);
  if (found.count == 0) return std::nullopt;
  SubsurfaceExit exit;
  exit.interaction = found.interaction;
  exit.interaction.wo = exit.interaction.shading.n;
  const SampledSpectrum density = below->bssrdf.Pdf(exit.interaction.p, exit.interaction.n);
  if (!(density[0] > 0)) return std::nullopt;
  exit.weight = below->bssrdf.Evaluate(exit.interaction.p) * (static_cast<float>(found.count) / density[0]);
  exit.densities = density * (1 / density[0]);
  if (!AnyNonZero(exit.weight)) return std::nullopt;
  exit.bsdf = Bsdf(exit.interaction.shading.n, below->exit);
  return exit;
}

}  // namespace tessera
