// Spheres, cylinders and disks: extent, and what the surface is like at a point.
#pragma once

#include "renderer/shape/double3.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// In rendering space (of a group: the group's). Conservative: a little larger than the surface.
Bounds3 QuadricBounds(const Quadric& quadric);

// Azimuth of an object-space point in [0, 2 pi).
float QuadricPhi(Point3 p);

// A point near the surface, in object space, moved onto it.
Double3 ProjectToQuadric(const Quadric& quadric, Double3 p);

// Parameters of an object-space point on the surface.
Point2 QuadricUv(const Quadric& quadric, Point3 p);
// Normal in object space, outward (disk: +z), not unit, not flipped.
Vec3 QuadricObjectNormal(const Quadric& quadric, Point3 p);
// Unit normal in rendering space at an object-space point, flipped if the quadric says so.
Normal3 QuadricNormal(const Quadric& quadric, Point3 p);
// Half size of a box, in object space, that holds the true point.
Vec3 QuadricPointError(const Quadric& quadric, Point3 p);

// Position, normals and derivatives at `p`, an object-space point near the surface; surface properties, wo
// and time are left alone.
void FillQuadricInteraction(const Quadric& quadric, Double3 p, SurfaceInteraction* interaction);

}  // namespace tessera
