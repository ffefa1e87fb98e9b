// The camera "realistic": a film behind a compound lens from a file, with true focus, distortion, vignetting
// and bokeh (Kolb et al. 1995, "A Realistic Camera Model for Computer Graphics").
#pragma once

#include <memory>

#include "renderer/camera/exit_pupil.h"

namespace tessera {

class RealisticCamera {
 public:
  // The distance of focus is measured from the film, a scene unit is a metre.
  static RealisticCamera Read(const CameraDirective& directive);

  bool has_lens() const { return true; }
  // The weight makes the mean over u_lens the irradiance of the film per radiance of an even surrounding.
  CameraRay GenerateRay(Point2 film, Point2 u_lens) const;

 private:
  struct Optics {
    LensSystem lens;
    Aperture aperture;
    ExitPupil pupil;
  };

  std::shared_ptr<const Optics> optics_;          // large: copies of the camera share it
  float picture_width_ = 1, picture_height_ = 1;  // pixels
  float film_width_ = 0, film_height_ = 0;        // metres
};

}  // namespace tessera
