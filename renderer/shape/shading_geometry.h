// Helpers with which forms fill the shading part of an interaction.
#pragma once

#include "renderer/math/transform.h"
#include "renderer/shape/double3.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// Scales tangents down whose squares would overflow.
inline void BoundTangents(SurfaceInteraction::Shading* shading) {
  constexpr float kLengthSquaredMax = 1e16f, kScale = 1e-8f;  // as pbrt's
  while (LengthSquared(shading->dpdu) > kLengthSquaredMax ||
         LengthSquared(shading->dpdv) > kLengthSquaredMax) {
    shading->dpdu *= kScale;
    shading->dpdv *= kScale;
  }
}

// Sets `shading` with bounded tangents. Its normal decides on which side the geometric normal lies.
inline void SetShading(const SurfaceInteraction::Shading& shading, SurfaceInteraction* interaction) {
  interaction->shading = shading;
  interaction->n = FaceForward(interaction->n, shading.n);
  BoundTangents(&interaction->shading);
}

// Derivatives of the unit normal of a surface by its parameters, from the derivatives of position (Weingarten
// equations; Pharr, Jakob, Humphreys 2023, section 6.2.4). Zero where the parametrisation is singular.
struct NormalDerivatives {
  Vec3 dndu, dndv;
};
NormalDerivatives DifferentiateNormal(Vec3 dpdu, Vec3 dpdv, Vec3 d2pduu, Vec3 d2pduv, Vec3 d2pdvv);

// v rotated by the smallest rotation that takes unit `from` to unit `to`.
Vec3 RotateFromTo(Vec3 v, Vec3 from, Vec3 to);

struct PointWithError {
  Point3 p;
  Vec3 error;
};
// Applies an affine transform to a point with a box of half size `error` around it. The new box also
// covers the rounding of the transform, and that of taking a ray the other way by the inverse matrix.
PointWithError TransformPointWithError(const Transform& transform, Double3 p, Vec3 error);

}  // namespace tessera
