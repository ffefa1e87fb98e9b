// Rectangles among emitting triangles.
#pragma once

#include <array>
#include <optional>

#include "renderer/math/float4.h"
#include "renderer/shape/hit_lanes.h"
#include "renderer/shape/patch.h"
#include "renderer/shape/shape_queries.h"
#include "renderer/shape/spherical_sampling.h"
#include "renderer/shape/triangle_mesh.h"

namespace tessera {

// Points on a rectangle that were sampled in several lanes.
struct RectangleSamples8 {
  LaneSet far = 0;   // the lanes that were sampled
  LaneSet seen = 0;  // those of them that see their point; the other members are not defined elsewhere
  Vec3x8 p;
  Float8 pdf;  // per solid angle
};

// Two triangles of a mesh that together are a rectangle, which is sampled as a whole: the choice between its
// halves is no source of noise, and its points are stratified over both. Immutable.
class RectangleEmitter {
 public:
  // Of triangles `primitive` and `primitive` + 1, which the mesh has. Returns nullopt if they form no
  // rectangle or if their normals are on different sides.
  static std::optional<RectangleEmitter> Find(const TriangleMesh& mesh, uint32_t primitive);

  // A point by solid angle, weighted by the cosine at the reference point's surface, or by area with weights
  // that approximate the same where the rectangle is far away. Returns nullopt if `reference` lies in its
  // plane, or if it is behind a rectangle that emits to one side. The point has no texture coordinates. u in
  // [0, 1)^2.
  std::optional<ShapeSample> Sample(const ReferencePoint& reference, Point2 u, bool two_sided) const;
  // Sample for the surface points of several lanes, as far as they are far from the rectangle.
  RectangleSamples8 SampleFar(const SurfacePoints8& references, Vec2x8 u, bool two_sided) const;
  Normal3 n() const { return n_; }
  // Of every sampled point.
  Vec3 p_error() const { return p_error_; }
  // The density per solid angle with which Sample finds point `p` of the rectangle.
  float Pdf(const ReferencePoint& reference, Point3 p) const;

 private:
  // The rectangle as a reference point sees it.
  struct View {
    SphericalRectangle sphere;
    BilinearWeights weights;  // equal for points in space
  };

  explicit RectangleEmitter(const PatchPoints& corners, Normal3 n);
  // The signed distance of the point from the plane, positive in front; 0 if rounding leaves it in the plane.
  float Height(const ReferencePoint& reference) const;
  View SeenFrom(const ReferencePoint& reference, float height) const;
  // What arrives from each corner, up to a factor, at a point that is far enough away to sample by these
  // weights; nullopt for other points.
  std::optional<BilinearWeights> FarWeights(const ReferencePoint& reference) const;
  // Of a point of the rectangle along its edges, in [0, 1]^2.
  Point2 PlaceOf(Point3 p) const;
  float Area() const { return width_ * height_; }

  Point3 corner_;
  Vec3 ex_, ey_;          // edges from the corner
  Vec3 unit_x_, unit_y_;  // their directions
  float width_, height_;  // their lengths
  Point3 center_;
  float radius_squared_;                      // of the circle through the corners
  Normal3 n_;                                 // unit
  Float4 corners_x_, corners_y_, corners_z_;  // in the order of BilinearWeights
  std::array<Point3, 4> corners_;             // the same
  Vec3 p_error_;                              // of a sampled point
  float plane_error_;                         // of the distance of points from the plane
};

}  // namespace tessera
