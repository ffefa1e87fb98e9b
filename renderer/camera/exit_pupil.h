// Where light leaves a compound lens towards the film: bounds of the exit pupil in the plane of the last
// interface, for each distance from the centre of the film (Steinert et al. 2011, "General Spectral Camera
// Lens Simulation").
#pragma once

#include <optional>
#include <vector>

#include "renderer/camera/lens_system.h"

namespace tessera {

// A box around the exit pupil as seen from a place on the +x axis of the film: [x0, x1] x [-y, y].
struct PupilBox {
  float x0 = 0, x1 = 0, y = 0;

  float Area() const { return (x1 - x0) * 2 * y; }
};

// A point of the plane of the last interface, chosen uniformly with respect to area.
struct PupilSample {
  Point2 p;
  float area = 0;  // that it was chosen from: 1 / density
};

// Immutable.
class ExitPupil {
 public:
  ExitPupil() = default;
  // For places up to `film_radius` from the centre, and stops that let light through within `aperture_radius`
  // times their own radius.
  ExitPupil(const LensSystem& lens, float aperture_radius, float film_radius);

  // The box for a place at this distance from the centre of the film. Returns nullopt if no light reaches it.
  const std::optional<PupilBox>& BoxAt(float distance) const;
  // The same for Sample, whose box is turned to the place on the film.
  std::optional<PupilSample> Sample(Point2 film, Point2 u) const;

 private:
  std::vector<std::optional<PupilBox>> boxes_;  // by distance, in equal steps
  float film_radius_ = 0;
};

}  // namespace tessera
