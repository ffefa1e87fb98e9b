// What textures are looked up with, and inputs of materials, lights and shapes that may be textures.
#pragma once

#include "renderer/color/spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

// Where a texture is looked up.
struct TextureContext {
  Point3 p;   // in rendering space
  Normal3 n;  // shading normal, for directional mixes
  Point2 uv;
  Vec3 dpdx, dpdy;                               // change of p per pixel of the image
  float dudx = 0, dudy = 0, dvdx = 0, dvdy = 0;  // change of uv per pixel
};

// A float that is either constant or a texture's.
struct FloatInput {
  float constant = 0;
  int texture = -1;  // index in the TextureTable, -1: constant
  bool operator==(const FloatInput&) const = default;
  bool IsConstant() const { return texture < 0; }
};

// A spectrum that is either constant or a texture's.
struct SpectrumInput {
  Spectrum constant;
  int texture = -1;
  bool IsConstant() const { return texture < 0; }
};

}  // namespace tessera
