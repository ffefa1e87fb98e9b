#include "renderer/integrator/random_walk_integrator.h"

#include "renderer/integrator/light_walk.h"
#include "renderer/math/sampling.h"

namespace tessera {

template <typename Sink>
void TraceRandomWalk(const PathContext& context, const Ray& camera_ray, Sink& sink) {
  using Event = typename LightWalk<Sink>::Event;
  LightWalk<Sink> walk(context, camera_ray, sink);
  for (;;) {
    const Event event = walk.Advance();
    if (event == Event::kEscaped) walk.AddInfiniteEmission();
    if (event == Event::kOnSurface) walk.AddSurfaceEmission();
    if (walk.EndsAt(event)) return;
    const Vec3 wi = SampleUniformSphere(context.sampler.Get2D());
    const Bsdf bsdf = walk.Scatterer();
    const SampledSpectrum f = bsdf.Evaluate(walk.interaction.wo, wi).f;
    if (!AnyNonZero(f)) return;
    const float cosine = AbsDot(wi, walk.interaction.shading.n);
    walk.Leave(walk.interaction.SpawnRay(wi), f * (cosine / UniformSpherePdf()),
               walk.VertexOf(bsdf, wi, false), false);
  }
}

template void TraceRandomWalk(const PathContext&, const Ray&, RadianceSink&);
template void TraceRandomWalk(const PathContext&, const Ray&, RecordingSink&);

}  // namespace tessera
