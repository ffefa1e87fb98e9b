// Follows several paths at the same time, ray by ray, so that parts of their work are done for all of them
// together. The radiance of each has the same bits as if it were followed alone (EstimateRadiance).
#pragma once

#include <memory>

#include "renderer/integrator/estimator.h"
#include "renderer/math/lanes.h"

namespace tessera {

// Used by one thread at a time. The settings of all paths are those of `estimator`, which must outlive the
// batch, as must the world and the counts.
class PathBatch {
 public:
  // Whether a batch follows the paths of the estimator: not in media, and by no integrator but `path` and
  // `volpath`.
  static bool Follows(const World& world, const Estimator& estimator);

  PathBatch(const World& world, const Estimator& estimator, const Sampler& sampler, RayCounts& counts);
  ~PathBatch();
  PathBatch(const PathBatch&) = delete;
  PathBatch& operator=(const PathBatch&) = delete;

  // Of the path in a lane: to be set before Start, and to be read after the path has ended.
  Sampler& sampler(int lane);
  SampledWavelengths& wavelengths(int lane);
  // Per wavelength: to be divided by the densities that the wavelengths then have.
  SampledSpectrum radiance(int lane) const;

  // The lanes that follow no path.
  LaneSet free_lanes() const { return kAllLanes & ~busy_; }
  // Starts a path in a free lane.
  void Start(int lane, const Ray& camera_ray);
  // Extends every path by one ray. Returns the lanes whose paths have ended, which are free then.
  LaneSet Extend();

 private:
  struct State;
  // If fewer paths meet plain surfaces, their vertices are computed one by one.
  static constexpr int kTogetherMin = 2;

  // Extends one path, whose ray has a hit that is not refined, or none. Returns false if it ends.
  bool ExtendAlone(int lane, bool is_found);

  const World& world_;
  const Estimator& estimator_;
  RayCounts& counts_;
  LaneSet busy_ = 0;
  std::unique_ptr<State> state_;
};

}  // namespace tessera
