#include "renderer/integrator/estimator.h"

#include "renderer/integrator/mixture_integrator.h"
#include "renderer/integrator/path_integrator.h"
#include "renderer/integrator/random_walk_integrator.h"

namespace tessera {
namespace {

template <typename Sink>
void Trace(const PathContext& context, const Estimator& estimator, const Ray& camera_ray, Sink& sink) {
  switch (estimator.integrator.kind) {
    case IntegratorKind::kPath: return TracePath(context, estimator.visibility.get(), camera_ray, sink);
    case IntegratorKind::kVolPath:
      // Without media both estimate the same radiance, and the first is faster.
      if (context.world.media.empty() && !context.world.has_subsurface)
        return TracePath(context, estimator.visibility.get(), camera_ray, sink);
      return TraceVolumePath(context, estimator.visibility.get(), camera_ray, sink);
    case IntegratorKind::kMixture: return TraceMixture(context, *estimator.lights, camera_ray, sink);
    case IntegratorKind::kSimplePath: return TraceSimplePath(context, estimator.techniques, camera_ray, sink);
    case IntegratorKind::kSimpleVolPath: return TraceSimplePath(context, {false, true}, camera_ray, sink);
    case IntegratorKind::kRandomWalk: return TraceRandomWalk(context, camera_ray, sink);
  }
}

}  // namespace

SampledSpectrum EstimateRadiance(const PathContext& context, const Estimator& estimator,
                                 const Ray& camera_ray) {
  RadianceSink sink;
  Trace(context, estimator, camera_ray, sink);
  return sink.radiance;
}

SampledSpectrum EstimateRadiance(const PathContext& context, const Estimator& estimator,
                                 const Ray& camera_ray, SampleRecorder& recorder) {
  RecordingSink sink(camera_ray, recorder);
  Trace(context, estimator, camera_ray, sink);
  return sink.radiance;
}

}  // namespace tessera
