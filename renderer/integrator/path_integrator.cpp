#include "renderer/integrator/path_integrator.h"

#include "renderer/integrator/path_tracer.h"

namespace tessera {

template <typename Sink>
void TracePath(const PathContext& context, const LightVisibility* visibility, const Ray& camera_ray,
               Sink& sink) {
  PathTracer<VacuumTransport, Sink>(context, visibility, camera_ray, sink).Trace();
}

template <typename Sink>
void TraceVolumePath(const PathContext& context, const LightVisibility* visibility, const Ray& camera_ray,
                     Sink& sink) {
  PathTracer<MediumTransport, Sink>(context, visibility, camera_ray, sink).Trace();
}

template void TracePath(const PathContext&, const LightVisibility*, const Ray&, RadianceSink&);
template void TracePath(const PathContext&, const LightVisibility*, const Ray&, RecordingSink&);
template void TraceVolumePath(const PathContext&, const LightVisibility*, const Ray&, RadianceSink&);
template void TraceVolumePath(const PathContext&, const LightVisibility*, const Ray&, RecordingSink&);

}  // namespace tessera
