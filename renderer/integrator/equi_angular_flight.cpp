#include "renderer/integrator/equi_angular_flight.h"

#include "renderer/medium/equi_angular.h"
#include "renderer/medium/flight.h"

namespace tessera {

std::optional<EquiAngularFlight::Place> EquiAngularFlight::Sample(float u_light, float u_distance) const {
  if (lights_ == nullptr) return std::nullopt;
  const std::optional<ChosenLight> chosen = lights_->ChooseAlong(ray_, extinction_, u_light);
  if (!chosen) return std::nullopt;
  const EquiAngular distances(ray_, *lights_->SphereOf(chosen->light));
  if (!IsNear(distances.distance())) return std::nullopt;
  const auto [t, pdf] = distances.Sample(u_distance);
  if (!(t < kFlightMax)) return std::nullopt;
  const float density = chosen->pmf * pdf;
  return Place{chosen->light, t, density, density / Average(CollisionDensities(t))};
}

float EquiAngularFlight::RelativeDensityOfStarted(int light, float t) const {
  const std::optional<BoundingSphere> sphere = lights_->SphereOf(light);
  if (!sphere) return 0;
  const EquiAngular distances(ray_, *sphere);
  if (!IsNear(distances.distance())) return 0;
  const float pmf = lights_->ChoosePmfAlong(ray_, extinction_, light);
  return pmf * distances.Pdf(t) / Average(CollisionDensities(t));
}

}  // namespace tessera
