// The procedural patterns, as functions of texture coordinates alone.
#pragma once

#include "renderer/texture/texture_mapping.h"

namespace tessera {

// The weight of the second colour of a checkerboard of unit squares or cubes, filtered by a tent as wide as
// the footprint: 0 or 1 inside a square, 1/2 under a wide footprint.
float CheckerboardWeight(const TextureCoordinates2& c);
float CheckerboardWeight(const TextureCoordinates3& c);

// Whether a point is inside a dot. Each unit square has at most one, at a random position.
bool InsideDot(Point2 st);

struct NoiseSettings {
  int octaves = 8;
  float roughness = 0.5f;
  float scale = 1, variation = 0.2f;  // of marble
};

float WindyWaves(const TextureCoordinates3& c);
// A linear sRGB albedo.
Vec3 MarbleColor(const TextureCoordinates3& c, const NoiseSettings& settings);

}  // namespace tessera
