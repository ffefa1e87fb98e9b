// A compound lens: spherical interfaces and an aperture stop on a common axis, traced exactly.
//
// The film lies in the plane z = 0 and light paths are followed from there towards the scene, along +z: the
// coordinates of camera space. Lengths are metres.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/camera/aperture.h"
#include "renderer/camera/camera_directive.h"
#include "renderer/util/result.h"

namespace tessera {

// One interface as lens files list it, from the scene towards the film.
struct LensInterface {
  float curvature_radius = 0;  // positive if the centre lies on the side of the film; 0: an aperture stop
  float thickness = 0;         // to the next interface; of the last one: to the film
  float eta = 1;               // refractive index behind the interface, on the side of the film
  float diameter = 0;          // of the opening
};

// The lens in the approximation for rays near the axis. Positions are distances from the vertex of the last
// interface towards the scene.
struct CardinalPoints {
  double focal_length = 0;
  double film_principal = 0;   // the principal plane for images, on the side of the film
  double scene_principal = 0;  // the one for objects
};

// The image of the stop seen from the film, in the approximation for rays near the axis.
struct ParaxialPupil {
  float z = 0, radius = 0;
};

// Immutable.
class LensSystem {
 public:
  LensSystem() = default;
  // There must be at least one interface. The distance to the film is that of the last interface.
  explicit LensSystem(const std::vector<LensInterface>& interfaces);

  // Reads the quadruples of a lens file: curvature radius, thickness (mm), index of refraction, diameter
  // (mm). The error does not name the file.
  static Result<std::vector<LensInterface>> ParseFile(const std::string& text);
  // Returns nullopt if the lens does not focus parallel light.
  static std::optional<CardinalPoints> FindCardinalPoints(const std::vector<LensInterface>& interfaces);
  // The distance between the last interface and the film at which an object `distance` before the film is in
  // focus. Returns nullopt if there is none.
  static std::optional<double> FilmDistance(const CardinalPoints& lens, double distance);

  // Where the plane of the last interface lies, and the radius of its opening.
  float rear_z() const { return rear_z_; }
  float rear_radius() const { return rear_radius_; }
  // Of the stop nearest to the film. Returns nullopt without a stop, or if its image is infinitely far away.
  std::optional<ParaxialPupil> FindParaxialPupil() const;

  // Follows a ray that starts on the film with a unit direction. The result starts on the first interface;
  // its weight is the transmittance of the aperture. Returns nullopt if the ray is blocked or totally
  // reflected.
  std::optional<CameraRay> Trace(Point3 o, Vec3 d, const Aperture& aperture) const;

 private:
  // From the film to the scene.
  struct Surface {
    float curvature_radius, z, radius;  // 0: a stop; position of the vertex; of the opening
    float eta_film, eta_scene;          // index of refraction on each side
  };

  std::vector<Surface> surfaces_;
  float rear_z_ = 0, rear_radius_ = 0;
};

}  // namespace tessera
