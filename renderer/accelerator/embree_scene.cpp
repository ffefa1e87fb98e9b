#include "renderer/accelerator/embree_scene.h"

#include <array>
#include <utility>

#include "renderer/accelerator/alpha_test.h"
#include "renderer/accelerator/embree_callbacks.h"
#include "renderer/shape/patch.h"

namespace tessera {
namespace {

// Shares the vertices with Embree, which loads 16 bytes at each, if the vector has room for one more;
// otherwise copies them.
void SetVertices(RTCGeometry geometry, const std::vector<Point3>& P) {
  static_assert(sizeof(Point3) == 3 * sizeof(float));
  if (P.capacity() > P.size()) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, P.data(), 0,
                               sizeof(Point3), P.size());
    return;
  }
  void* copy = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Point3),
                                       P.size());
  if (copy) std::copy(P.begin(), P.end(), static_cast<Point3*>(copy));
}

// The longest edge or diagonal of faces of `corners` vertices each.
float LongestEdge(const std::vector<Point3>& P, const std::vector<uint32_t>& indices, size_t corners) {
  float longest_squared = 0;
  for (size_t face = 0; face + corners <= indices.size(); face += corners) {
    for (size_t i = 0; i < corners; ++i) {
      for (size_t j = 0; j < i; ++j) {
        const float squared = DistanceSquared(P[indices[face + i]], P[indices[face + j]]);
        longest_squared = std::max(longest_squared, squared);
      }
    }
  }
  return std::sqrt(longest_squared);
}

// Whether there are no more primitives than are tried as fast as they are searched, none of them Embree's.
bool AreFewUserPrimitives(std::span<const Shape> shapes) {
  constexpr uint64_t kFew = 8;
  uint64_t count = 0;
  for (const Shape& shape : shapes) {
    if (IsNeverHit(shape)) continue;
    const bool is_ours =
        std::holds_alternative<Quadric>(shape.form) || std::holds_alternative<CurveSet>(shape.form);
    count += shape.PrimitiveCount();
    if (!is_ours || count > kFew) return false;
  }
  return true;
}

}  // namespace

// NOLINTNEXTLINE(performance-unnecessary-value-param): it is moved once the template is instantiated.
void EmbreeScene::Add(const EmbreeDevice& device, const ShapeForm auto& form, EmbreeGeometryRecord record) {
  AddUserPrimitives(device, form.PrimitiveCount(), std::move(record));
}

EmbreeScene::EmbreeScene(const EmbreeDevice& device, std::span<const Shape> shapes, Use use) {
  records_.reserve(2 * shapes.size());  // a mesh of patches may be two geometries
  const bool is_left_out = use == Use::kByUs && AreFewUserPrimitives(shapes);
  if (!is_left_out) {
    scene_.reset(rtcNewScene(device.handle()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_MEDIUM);
  }
  for (size_t i = 0; i < shapes.size(); ++i) {
    const Shape& shape = shapes[i];
    if (IsNeverHit(shape)) continue;
    EmbreeGeometryRecord record{&shape, static_cast<uint32_t>(i), {}};
    if (is_left_out) {
      records_.push_back(std::move(record));
    } else {
      Dispatch(shape.form, [&](const auto& form) { Add(device, form, std::move(record)); });
    }
  }
}

Bounds3 EmbreeScene::Bounds() const {
  Bounds3 bounds;
  if (scene_) {
    RTCBounds b;
    rtcGetSceneBounds(scene_.get(), &b);
    return {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
  }
  for (const EmbreeGeometryRecord& record : records_) bounds.Add(record.shape->Bounds());
  return bounds;
}

void EmbreeScene::Add(const EmbreeDevice& device, const TriangleMesh& mesh, EmbreeGeometryRecord record) {
  const EmbreeGeometryHandle geometry(rtcNewGeometry(device.handle(), RTC_GEOMETRY_TYPE_TRIANGLE));
  SetVertices(geometry.get(), mesh.P);
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(),
                             0, 3 * sizeof(uint32_t), mesh.indices.size() / 3);
  record.edge_max = LongestEdge(mesh.P, mesh.indices, 3);
  Attach(geometry.get(), std::move(record));
}

void EmbreeScene::Add(const EmbreeDevice& device, const BilinearMesh& mesh, EmbreeGeometryRecord record) {
  const uint32_t count = record.shape->PrimitiveCount();
  EmbreeGeometryRecord flat = record;
  for (uint32_t i = 0; i < count; ++i) {
    (IsParallelogram(mesh.At(i)) ? flat : record).primitives.push_back(i);
  }
  if (!flat.primitives.empty()) AddQuads(device, mesh, std::move(flat));
  const uint32_t curved_count = static_cast<uint32_t>(record.primitives.size());
  if (curved_count > 0) AddUserPrimitives(device, curved_count, std::move(record));
}

// Embree cuts a quad into two triangles, which for a parallelogram is exact, with the same (u, v).
void EmbreeScene::AddQuads(const EmbreeDevice& device, const BilinearMesh& mesh,
                           EmbreeGeometryRecord record) {
  const EmbreeGeometryHandle geometry(rtcNewGeometry(device.handle(), RTC_GEOMETRY_TYPE_QUAD));
  SetVertices(geometry.get(), mesh.P);
  using Quad = std::array<uint32_t, 4>;
  auto* quad = static_cast<Quad*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, sizeof(Quad), record.primitives.size()));
  if (!quad) return;  // out of memory: reported by the device
  for (const uint32_t i : record.primitives) {
    const uint32_t* v = &mesh.indices[4 * size_t{i}];
    *quad++ = {v[0], v[1], v[3], v[2]};  // around the patch
  }
  record.edge_max = LongestEdge(mesh.P, mesh.indices, 4);
  Attach(geometry.get(), std::move(record));
}

void EmbreeScene::AddUserPrimitives(const EmbreeDevice& device, uint32_t count, EmbreeGeometryRecord record) {
  const EmbreeGeometryHandle geometry(rtcNewGeometry(device.handle(), RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(geometry.get(), count);
  SetUserPrimitiveCallbacks(geometry.get());
  Attach(geometry.get(), std::move(record));
}

void EmbreeScene::Attach(RTCGeometry geometry, EmbreeGeometryRecord record) {
  const uint32_t id = static_cast<uint32_t>(records_.size());
  const SurfaceProperties& surface = record.shape->surface;
  records_.push_back(std::move(record));
  rtcSetGeometryUserData(geometry, &records_.back());
  rtcSetGeometryMask(geometry, MaskOf(*records_.back().shape));
  // Embree calls filters for triangles and quads only; our own primitives need none.
  if (surface.HasAlpha()) {
    SetAlphaFilter(geometry);
  } else {
    SetOcclusionFilter(geometry);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, id);
}

}  // namespace tessera
