#include "renderer/shape/displaced_mesh.h"

#include <unordered_map>

#include <fmt/format.h>

#include "renderer/util/load_budget.h"

namespace tessera {
namespace {

// The mean of the unit normals of the triangles at each vertex.
std::vector<Normal3> NormalsOf(const MeshData& mesh) {
  std::vector<Normal3> normals(mesh.P.size());
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Point3 p0 = mesh.P[mesh.indices[i]], p1 = mesh.P[mesh.indices[i + 1]],
                 p2 = mesh.P[mesh.indices[i + 2]];
    const Vec3 n = Cross(p1 - p0, p2 - p1);
    const float length = Length(n);
    if (!(length > 0)) continue;
    for (size_t corner = 0; corner < 3; ++corner) {
      Normal3& sum = normals[mesh.indices[i + corner]];
      sum = sum + n / length;
    }
  }
  for (Normal3& n : normals) {
    const float length = Length(n);
    if (length > 0) n = n / length;
  }
  return normals;
}

class Refinement {
 public:
  Refinement(MeshData& mesh, const Displacement& displacement) : mesh_(mesh), displacement_(displacement) {}

  // Returns whether there are few enough triangles.
  bool Run() {
    const std::vector<uint32_t> given = std::move(mesh_.indices);
    mesh_.indices.clear();
    for (size_t i = 0; i < given.size(); i += 3) {
      if (!Split(given[i], given[i + 1], given[i + 2])) return false;
    }
    return true;
  }

 private:
  float EdgeLength(uint32_t a, uint32_t b) const {
    const Transform& transform = displacement_.render_from_object;
    return Length(transform.ToPoint(mesh_.P[a]) - transform.ToPoint(mesh_.P[b]));
  }
  // Splits the longest edge while any is too long. The depth is that of halving a float.
  bool Split(uint32_t v0, uint32_t v1, uint32_t v2) {
    const float d01 = EdgeLength(v0, v1), d12 = EdgeLength(v1, v2), d20 = EdgeLength(v2, v0);
    if (d01 > d12 && d01 > d20) return SplitAt(d01, v0, v1, v2);
    if (d12 > d20) return SplitAt(d12, v1, v2, v0);
    return SplitAt(d20, v2, v0, v1);
  }
  // The edge (a, b) of length `longest` is the longest of the triangle (a, b, c).
  bool SplitAt(float longest, uint32_t a, uint32_t b, uint32_t c) {
    const Point3 middle = (mesh_.P[a] + mesh_.P[b]) * 0.5f;
    const bool can_split = !(middle == mesh_.P[a]) && !(middle == mesh_.P[b]);
    if (longest < displacement_.edge_length || !can_split) {
      mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
      constexpr size_t kBudgetInterval = 3 * 4096;
      if (mesh_.indices.size() % kBudgetInterval == 0) CheckLoadBudget();
      return mesh_.indices.size() / 3 <= kDisplacedTrianglesMax;
    }
    const uint32_t split = MiddleOf(a, b, middle);
    return Split(a, split, c) && Split(split, b, c);
  }
  uint32_t MiddleOf(uint32_t a, uint32_t b, Point3 middle) {
    const uint64_t edge = uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    const auto [place, is_new] = middles_.try_emplace(edge, static_cast<uint32_t>(mesh_.P.size()));
    if (is_new) {
      mesh_.P.push_back(middle);
      const Vec3 n = mesh_.N[a] + mesh_.N[b];
      const float length = Length(n);
      mesh_.N.push_back(length > 0 ? n / length : mesh_.N[a]);
      const Point2 uv_a = mesh_.uv[a], uv_b = mesh_.uv[b];
      mesh_.uv.push_back({(uv_a.x + uv_b.x) * 0.5f, (uv_a.y + uv_b.y) * 0.5f});
    }
    return place->second;
  }

  MeshData& mesh_;
  const Displacement& displacement_;
  std::unordered_map<uint64_t, uint32_t> middles_;  // of split edges; never iterated over
};

}  // namespace

Result<MeshData> Displace(MeshData mesh, const Displacement& displacement) {
  if (mesh.N.empty()) mesh.N = NormalsOf(mesh);
  if (!Refinement(mesh, displacement).Run()) {
    return BadInput(fmt::format("edges of length {} would make more than {} triangles",
                                displacement.edge_length, kDisplacedTrianglesMax));
  }
  for (size_t i = 0; i < mesh.P.size(); ++i) {
    const float height = displacement.height(mesh.P[i], mesh.N[i], mesh.uv[i]);
    mesh.P[i] = mesh.P[i] + mesh.N[i] * height;
  }
  mesh.N = NormalsOf(mesh);
  return mesh;
}

}  // namespace tessera
