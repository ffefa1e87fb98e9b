#include "renderer/camera/thin_lens.h"

namespace tessera {

ThinLens ThinLens::Read(ParameterReader& reader, float default_focal_distance) {
  ThinLens lens;
  lens.radius = reader.Float("lensradius", 0);
  lens.focal_distance = reader.Float("focaldistance", default_focal_distance);
  if (lens.radius < 0) reader.FailAt("lensradius", "lensradius must not be negative");
  if (!(lens.focal_distance > 0)) reader.FailAt("focaldistance", "focaldistance must be above 0");
  return lens;
}

}  // namespace tessera
