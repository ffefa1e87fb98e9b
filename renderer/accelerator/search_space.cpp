#include "renderer/accelerator/search_space.h"

#include <algorithm>
#include <cmath>

#include "renderer/accelerator/alpha_test.h"

namespace tessera {
namespace {

bool IsFinite(const Bounds3& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(b.min[axis]) || !std::isfinite(b.max[axis])) return false;
  }
  return true;
}

Bounds3 TriangleBounds(const TrianglePoints& triangle) {
  Bounds3 bounds;
  bounds.Add(triangle.p0);
  bounds.Add(triangle.p1);
  bounds.Add(triangle.p2);
  return bounds;
}

// A parallelogram consists of two triangles that share its diagonal.
TrianglePoints HalfPatch(const PatchPoints& patch, PrimitiveKind half) {
  if (half == PrimitiveKind::kPatchHalf0) return {patch.p00, patch.p10, patch.p11};
  return {patch.p00, patch.p11, patch.p01};
}

TrianglePoints PointsOf(const Shape& shape, const PrimitiveName& name) {
  if (name.kind == PrimitiveKind::kTriangle) {
    return std::get<TriangleMesh>(shape.form).At(name.primitive);
  }
  return HalfPatch(std::get<BilinearMesh>(shape.form).At(name.primitive), name.kind);
}

class Collector {
 public:
  explicit Collector(std::vector<BoxedPrimitive>* primitives) : primitives_(*primitives) {}

  void Add(const Shape& shape, uint32_t index) {
    name_ = {index, 0, {}, shape.surface.HasAlpha(), shape.surface.StopsShadowRays()};
    Dispatch(shape.form, [this](const auto& form) { AddForm(form); });
  }

 private:
  void AddForm(const TriangleMesh& mesh) {
    const uint32_t count = mesh.PrimitiveCount();
    for (uint32_t i = 0; i < count; ++i) Push(i, PrimitiveKind::kTriangle, mesh.PrimitiveBounds(i));
  }
  void AddForm(const BilinearMesh& mesh) {
    const uint32_t count = mesh.PrimitiveCount();
    for (uint32_t i = 0; i < count; ++i) {
      const PatchPoints patch = mesh.At(i);
      if (!IsParallelogram(patch)) {
        Push(i, PrimitiveKind::kOther, mesh.PrimitiveBounds(i));
        continue;
      }
      for (const PrimitiveKind half : {PrimitiveKind::kPatchHalf0, PrimitiveKind::kPatchHalf1}) {
        Push(i, half, TriangleBounds(HalfPatch(patch, half)));
      }
    }
  }
  void AddForm(const ShapeForm auto& form) {
    const uint32_t count = form.PrimitiveCount();
    for (uint32_t i = 0; i < count; ++i) Push(i, PrimitiveKind::kOther, form.PrimitiveBounds(i));
  }

  void Push(uint32_t primitive, PrimitiveKind kind, const Bounds3& bounds) {
    if (!IsFinite(bounds)) return;
    name_.primitive = primitive;
    name_.kind = kind;
    primitives_.push_back({bounds, name_});
  }

  std::vector<BoxedPrimitive>& primitives_;
  PrimitiveName name_;
};

}  // namespace

std::vector<BoxedPrimitive> CollectPrimitives(std::span<const Shape> shapes) {
  std::vector<BoxedPrimitive> primitives;
  Collector collector(&primitives);
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (!IsNeverHit(shapes[i])) collector.Add(shapes[i], static_cast<uint32_t>(i));
  }
  return primitives;
}

TriangleBlock MakeBlock(std::span<const Shape> shapes, std::span<const BoxedPrimitive> triangles) {
  TriangleBlock block{};
  for (size_t lane = 0; lane < triangles.size(); ++lane) {
    const PrimitiveName& name = triangles[lane].name;
    const TrianglePoints points = PointsOf(shapes[name.shape], name);
    for (int axis = 0; axis < 3; ++axis) {
      block.p[0][axis][lane] = points.p0[axis];
      block.p[1][axis][lane] = points.p1[axis];
      block.p[2][axis][lane] = points.p2[axis];
    }
    block.shape[lane] = name.shape;
    block.primitive[lane] = name.primitive;
    const auto bit = static_cast<uint8_t>(1u << lane);
    block.used |= bit;
    if (name.has_alpha) block.with_alpha |= bit;
    if (!name.stops_shadow_rays) block.passed_by_shadow_rays |= bit;
    if (name.kind != PrimitiveKind::kTriangle) block.of_patches |= bit;
  }
  return block;
}

SearchSpace MakeListSpace(std::span<const Shape> shapes, std::span<const BoxedPrimitive> primitives) {
  SearchSpace space;
  std::vector<BoxedPrimitive> triangles;
  const auto flush = [&] {
    if (!triangles.empty()) space.blocks.push_back(MakeBlock(shapes, triangles));
    triangles.clear();
  };
  for (const BoxedPrimitive& primitive : primitives) {
    space.bounds.Add(primitive.bounds);
    if (!IsTriangle(primitive.name.kind)) {
      space.others.push_back({primitive.bounds, primitive.name});
      continue;
    }
    triangles.push_back(primitive);
    if (triangles.size() == TriangleBlock::kLanes) flush();
  }
  flush();
  space.cost = static_cast<double>(space.blocks.size() + space.others.size());
  return space;
}

}  // namespace tessera
