// One Embree scene: the shapes of a space, top level or a group's.
#pragma once

#include <span>
#include <vector>

#include "renderer/accelerator/embree_device.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// The geometries that a ray can hit: all, or all except those that shadow rays pass.
enum EmbreeRayMask : unsigned { kSolidMask = 1, kPassedMask = 2, kAllMask = 3 };

inline unsigned MaskOf(const Shape& shape) {
  return shape.surface.StopsShadowRays() ? kSolidMask : kPassedMask;
}

// The source of one Embree geometry: a shape, or those of its patches that are (not) parallelograms.
struct EmbreeGeometryRecord {
  const Shape* shape = nullptr;
  uint32_t shape_index = 0;
  std::vector<uint32_t> primitives;  // empty: Embree's primitive i is the shape's
  float edge_max = 0;                // longest edge or diagonal of a triangle or quad

  uint32_t Primitive(uint32_t embree_primitive) const {
    return primitives.empty() ? embree_primitive : primitives[embree_primitive];
  }
};

// Immutable once committed. The shapes must outlive it.
class EmbreeScene {
 public:
  enum class Use {
    kByEmbree,
    // Where the caller can search a few primitives itself: for those the scene of Embree, which takes some
    // kilobytes, is left out.
    kByUs,
  };

  // Adds all shapes except those that are never hit. Geometry ids are 0, 1, 2, ... in order of shapes.
  EmbreeScene(const EmbreeDevice& device, std::span<const Shape> shapes, Use use = Use::kByEmbree);

  // Null if it was left out: then all primitives are to be tried (TryUserPrimitives).
  RTCScene handle() const { return scene_.get(); }
  Bounds3 Bounds() const;  // of the committed scene
  size_t geometry_count() const { return records_.size(); }
  std::span<const EmbreeGeometryRecord> records() const { return records_; }
  const EmbreeGeometryRecord& record(uint32_t geometry) const { return records_[geometry]; }

 private:
  void Add(const EmbreeDevice& device, const TriangleMesh& mesh, EmbreeGeometryRecord record);
  void Add(const EmbreeDevice& device, const BilinearMesh& mesh, EmbreeGeometryRecord record);
  void Add(const EmbreeDevice& device, const ShapeForm auto& form, EmbreeGeometryRecord record);
  void AddQuads(const EmbreeDevice& device, const BilinearMesh& mesh, EmbreeGeometryRecord record);
  // Primitives that Embree does not know, intersected by their form.
  void AddUserPrimitives(const EmbreeDevice& device, uint32_t count, EmbreeGeometryRecord record);
  void Attach(RTCGeometry geometry, EmbreeGeometryRecord record);

  std::vector<EmbreeGeometryRecord> records_;  // never reallocated: callbacks hold pointers to them
  EmbreeSceneHandle scene_;
};

}  // namespace tessera
