// The forms that a shape can have. To add one, write a struct that satisfies ShapeForm in files of its own
// and append it to Form (here, and nowhere else); the compiler rejects a form that lacks a function. Both
// accelerators hold every form: a form that they have no faster way for is intersected by its own Intersect.
#pragma once

#include <concepts>
#include <optional>
#include <string_view>
#include <variant>

#include "renderer/math/bounds.h"
#include "renderer/shape/bilinear_mesh.h"
#include "renderer/shape/curve_set.h"
#include "renderer/shape/interaction.h"
#include "renderer/shape/quadric.h"
#include "renderer/shape/shape_queries.h"
#include "renderer/shape/triangle_mesh.h"

namespace tessera {

// A form consists of primitives, numbered from 0. It lies in rendering space, or in the space of its group if
// it is instanced.
template <typename T>
concept ShapeForm = requires(const T& form, uint32_t primitive, const DoubleRay& ray, double t_max,
                             Crossing* crossing, const HitRay& hit_ray, const Hit& hit, Hit* refined,
                             SurfaceInteraction* interaction, HitPoint* point,
                             const ReferencePoint& reference, Point2 u, bool needs_uv, Vec3 wi,
                             const SurfaceInteraction& on_light) {
  // What lists call its primitives, in the plural: "triangles".
  { T::kPrimitives } -> std::convertible_to<std::string_view>;
  { form.PrimitiveCount() } -> std::same_as<uint32_t>;
  // Memory in addition to the struct itself.
  { form.Bytes() } -> std::same_as<uint64_t>;
  // Conservative: no point of the surface lies outside.
  { form.PrimitiveBounds(primitive) } -> std::same_as<Bounds3>;

  // The nearest crossing with t in (0, t_max]; false if there is none. In double precision: a ray that starts
  // outside the box SurfaceInteraction::p_error does not find the surface it left.
  { form.Intersect(primitive, ray, t_max, crossing) } -> std::same_as<bool>;
  // The largest number of times that a line meets the primitive, at most kCrossingsMax.
  { form.CrossingsMax(primitive) } -> std::same_as<int>;
  // Recomputes a hit found by a kernel that is not exact (hit_refinement.h).
  { form.Refine(hit_ray, refined) } -> std::same_as<bool>;

  // Fills position, error, normals, texture coordinates and derivatives; leaves the other members alone.
  { form.FillInteraction(hit, hit_ray, interaction) } -> std::same_as<void>;
  // Fills uv and n.
  { form.FillHitPoint(hit, hit_ray, point) } -> std::same_as<void>;

  // These serve emitters, which are never instanced: see shape_sampling.h.
  { form.Sample(primitive, reference, u, needs_uv) } -> std::same_as<std::optional<ShapeSample>>;
  { form.Pdf(primitive, reference, wi, on_light) } -> std::same_as<float>;
  { form.Area(primitive) } -> std::same_as<float>;
  { form.Normals(primitive) } -> std::same_as<NormalCone>;
};

template <ShapeForm... Forms>
using FormOf = std::variant<Forms...>;

using Form = FormOf<TriangleMesh, BilinearMesh, Quadric, CurveSet>;

}  // namespace tessera
