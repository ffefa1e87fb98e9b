// From a point on a surface to the coordinates of a texture.
#pragma once

#include "renderer/math/transform.h"
#include "renderer/texture/texture_inputs.h"

namespace tessera {

class Diagnostics;
class ParameterReader;

// A point of a two-dimensional texture and its change per pixel of the image. Always finite.
struct TextureCoordinates2 {
  Point2 st;
  Vec2 dx, dy;
};

// The same in three dimensions; may be infinite.
struct TextureCoordinates3 {
  Point3 p;
  Vec3 dpdx, dpdy;
};

struct TextureMapping {
  enum class Kind : uint8_t { kUv, kSpherical, kCylindrical, kPlanar, kSpace };

  Kind kind = Kind::kUv;
  Vec2 scale{1, 1};               // of kUv
  Vec2 offset;                    // of kUv and kPlanar
  Vec3 s_axis, t_axis;            // of kPlanar
  Transform texture_from_render;  // of all but kUv

  TextureCoordinates2 Map2(const TextureContext& context) const;  // of all but kSpace
  TextureCoordinates3 Map3(const TextureContext& context) const;  // of kSpace
};

// The parameters mapping, uscale, vscale, udelta, vdelta, v1 and v2.
TextureMapping ReadTextureMapping(ParameterReader& reader, const Transform& texture_from_render,
                                  Diagnostics& diagnostics);
TextureMapping SpaceMapping(const Transform& texture_from_render);

}  // namespace tessera
