// An image of normals in the frame of the surface.
#pragma once

#include <array>
#include <memory>

#include "renderer/image/image.h"
#include "renderer/math/vec.h"

namespace tessera {

class NormalMap {
 public:
  // `channels` are the indices of R, G and B, which hold (n + 1) / 2.
  NormalMap(std::shared_ptr<const Image> image, std::array<int, 3> channels)
      : image_(std::move(image)), channels_(channels) {}

  // Returns the unit normal at uv, interpolated bilinearly; the image repeats in both directions, v = 1 is
  // its top. Returns (0, 0, 1) where the image holds no direction.
  Vec3 Lookup(Point2 uv) const;

 private:
  std::shared_ptr<const Image> image_;
  std::array<int, 3> channels_;
};

}  // namespace tessera
