// The luminous intensity of a luminaire over directions, as photometry files of IES LM-63 (.ies) give it:
// the editions of 1986, 1991, 1995, 2002 and 2019. Immutable once read.
#pragma once

#include <string_view>
#include <vector>

#include "renderer/math/vec.h"
#include "renderer/util/result.h"

namespace tessera {

// Type C photometry, bilinear between the angles that were measured.
class IesProfile {
 public:
  IesProfile() = default;
  // Refuses photometry of the types A and B, tilt factors in a file of their own and what is damaged.
  // Messages start with "line N: ".
  static Result<IesProfile> Read(std::string_view text);

  bool empty() const { return candela_.empty(); }
  // In candela, along the unit direction d in the space of the luminaire: its vertical is z, the vertical
  // angle 0 is -z, the horizontal angle 0 is +x and 90 degrees is +y. 0 outside the vertical angles of the
  // file.
  float Intensity(Vec3 d) const;
  // Over the sphere.
  float Mean() const;

 private:
  friend class IesReader;
  // How the horizontal angles of the file cover the circle.
  enum class Symmetry {
    kAxial,      // one angle
    kQuadrants,  // 0 to 90
    kSides,      // 0 to 180
    kFrontBack,  // 90 to 270
    kNone,       // 0 to 360; a gap at the end is interpolated over
  };

  // The angle in the range of the file that has the intensity of `horizontal`, in degrees in [0, 360].
  float Fold(float horizontal) const;
  float At(size_t horizontal, size_t vertical) const {
    return candela_[horizontal * vertical_.size() + vertical];
  }

  Symmetry symmetry_ = Symmetry::kAxial;
  std::vector<float> vertical_, horizontal_;  // degrees, rising
  std::vector<float> candela_;                // for each horizontal angle those of all vertical ones
};

}  // namespace tessera
