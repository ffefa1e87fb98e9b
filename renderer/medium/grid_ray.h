// A medium ray (majorant.h) through a medium whose density is bounded by a coarse grid.
#pragma once

#include "renderer/math/ray.h"
#include "renderer/medium/grid_placement.h"
#include "renderer/medium/majorant.h"
#include "renderer/medium/majorant_grid.h"

namespace tessera {

// A Field is the coefficients of a medium at the wavelengths of a path:
//   const GridPlacement& placement() const;
//   const MajorantGrid& majorants() const;
//   SampledSpectrum MajorantOf(float bound) const;   of scattering plus absorption
//   MediumPoint PointAt(Point3 position) const;      position is in the box of the placement
// Empty cells that follow each other are one stretch.
template <typename Field>
class GridRay {
 public:
  // `field` must outlive this. Not inlined, so that callers stay fast in uniform media.
  [[gnu::noinline]] GridRay(const Field& field, const Ray& ray)
      : field_(field),
        o_(field.placement().PositionOf(ray.o)),
        d_(field.placement().DirectionOf(ray.d)),
        walk_(field.majorants().Walk(o_, d_, field.placement().box())),
        t_empty_(walk_.t_enter()) {}

  [[gnu::noinline]] bool Next(MajorantSegment* segment) {
    if (has_next_) {
      has_next_ = false;
      SetTo(next_.t_end, field_.majorants()[next_.cell], segment);
      return true;
    }
    float t_empty = t_empty_;  // where a stretch of empty cells ends; not above 0: there is none
    t_empty_ = 0;
    while (walk_.Next(&next_)) {
      const float bound = field_.majorants()[next_.cell];
      if (bound > 0 && t_empty <= 0) {
        SetTo(next_.t_end, bound, segment);
        return true;
      }
      has_next_ = bound > 0;
      if (has_next_) break;
      t_empty = next_.t_end;
    }
    SetTo(t_empty, 0, segment);
    return t_empty > 0 && t_empty < std::numeric_limits<float>::infinity();
  }

  MediumPoint At(float t) const { return field_.PointAt(o_ + d_ * t); }

 private:
  void SetTo(float t_end, float bound, MajorantSegment* segment) const {
    *segment = {};
    segment->t_end = t_end;
    if (bound > 0) segment->sigma_maj = field_.MajorantOf(bound);
  }

  const Field& field_;
  Point3 o_;
  Vec3 d_;
  GridWalk walk_;
  float t_empty_;
  GridWalk::Step next_;  // a cell that is not empty, if has_next_
  bool has_next_ = false;
};

}  // namespace tessera
