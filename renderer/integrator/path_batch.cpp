#include "renderer/integrator/path_batch.h"

#include <bit>
#include <optional>

#include "renderer/integrator/plain_vertices.h"
#include "renderer/shape/hit_refinement.h"

namespace tessera {

struct PathBatch::State {
  struct Lane {
    Sampler sampler;
    SampledWavelengths wavelengths;
    RadianceSink sink;
    std::optional<SurfacePath> path;
  };

  State(const World& world, const Estimator& estimator) : vertices(world, *estimator.plain) {}

  Lane lanes[kLanes];
  SurfacePaths paths;
  PlainVertices vertices;
};

bool PathBatch::Follows(const World& world, const Estimator& estimator) {
  if (estimator.plain == nullptr || !estimator.plain->any() || estimator.path.force_diffuse ||
      world.accelerator->lane_search() == nullptr)
    return false;
  switch (estimator.integrator.kind) {
    case IntegratorKind::kPath: return true;
    case IntegratorKind::kVolPath: return world.media.empty() && !world.has_subsurface;
    case IntegratorKind::kMixture:
    case IntegratorKind::kSimplePath:
    case IntegratorKind::kSimpleVolPath:
    case IntegratorKind::kRandomWalk: return false;
  }
  return false;
}

PathBatch::PathBatch(const World& world, const Estimator& estimator, const Sampler& sampler,
                     RayCounts& counts)
    : world_(world),
      estimator_(estimator),
      counts_(counts),
      state_(std::make_unique<State>(world, estimator)) {
  for (State::Lane& lane : state_->lanes) lane.sampler = sampler;
}

PathBatch::~PathBatch() = default;

Sampler& PathBatch::sampler(int lane) {
  return state_->lanes[lane].sampler;
}

SampledWavelengths& PathBatch::wavelengths(int lane) {
  return state_->lanes[lane].wavelengths;
}

SampledSpectrum PathBatch::radiance(int lane) const {
  return state_->lanes[lane].sink.radiance;
}

void PathBatch::Start(int lane, const Ray& camera_ray) {
  State::Lane& started = state_->lanes[lane];
  started.sink.radiance = SampledSpectrum(0.0f);
  const PathContext context{world_, estimator_.path, started.wavelengths, started.sampler, counts_};
  started.path.emplace(context, estimator_.visibility.get(), camera_ray, started.sink);
  state_->paths.paths[lane] = &*started.path;
  busy_ |= LaneSet{1} << lane;
}

LaneSet PathBatch::Extend() {
  if (busy_ == 0) return 0;
  SurfacePaths& paths = state_->paths;
  HitLanes& hits = paths.hits;
  ForEachLane(busy_, [&](int lane) { hits.rays[lane] = &paths.paths[lane]->BeginFlight(); });
  const LaneSet found = world_.accelerator->lane_search()->Find(busy_, &hits);
  LaneSet plain = 0;
  ForEachLane(found, [&](int lane) {
    plain |= LaneSet{estimator_.plain->At(hits.hits[lane]).reflectance != nullptr} << lane;
  });
  LaneSet alone = busy_, ended = 0;
  if (std::popcount(plain) >= kTogetherMin) {
    const PlainVertices::Outcome outcome = state_->vertices.Scatter(plain, paths);
    alone &= ~plain | outcome.refused;
    ended = outcome.ended;
  }
  ForEachLane(alone, [&](int lane) { ended |= LaneSet{!ExtendAlone(lane, HasLane(found, lane))} << lane; });
  busy_ &= ~ended;
  return ended;
}

bool PathBatch::ExtendAlone(int lane, bool is_found) {
  SurfacePath& path = *state_->paths.paths[lane];
  const Ray& ray = *state_->paths.hits.rays[lane];
  Hit& hit = state_->paths.hits.hits[lane];
  const bool is_hit =
      is_found && (RefineHit(world_.geometry, ray, &hit) || world_.accelerator->Intersect(ray, &hit));
  if (!is_hit) return path.Escape();
  SurfaceInteraction interaction = MakeInteraction(world_.geometry, hit, ray);
  return path.MeetSurface(hit, interaction);
}

}  // namespace tessera
