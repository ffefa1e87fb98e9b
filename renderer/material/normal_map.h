// A picture of normals in the frame of the surface.
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

  // The unit normal at uv: bilinear, repeated in both directions, v = 1 at the top. (0, 0, 1) where the
  // picture holds none.
  Vec3 Lookup(Point2 uv) const;

 private:
  std::shared_ptr<const Image> image_;
  std::array<int, 3> channels_;
};

}  // namespace tessera
