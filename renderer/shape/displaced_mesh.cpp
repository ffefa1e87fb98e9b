#include "renderer/shape/displaced_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>

#include "renderer/shape/double3.h"
#include "renderer/shape/made_triangles.h"
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
    if (!(LeastTriangles() <= static_cast<double>(kMadeTrianglesMax))) return false;
    const std::vector<uint32_t> given = std::move(mesh_.indices);
    mesh_.indices.clear();
    for (size_t i = 0; i < given.size(); i += 3) {
      if (!Split(given[i], given[i + 1], given[i + 2], 0)) return false;
    }
    return true;
  }

 private:
  // A depth that no mesh of floats reaches by halving its edges. Where rounding decides, halves may be as
  // long as the whole.
  static constexpr int kDepthMax = 1000;
  // Relative to the coordinates: edges of a few units in the last place.
  static constexpr float kUnresolved = 8 * std::numeric_limits<float>::epsilon();

  Vec3 EdgeInRender(uint32_t a, uint32_t b) const {
    const Transform& transform = displacement_.render_from_object;
    return transform.ToPoint(mesh_.P[a]) - transform.ToPoint(mesh_.P[b]);
  }
  float EdgeLength(uint32_t a, uint32_t b) const { return Length(EdgeInRender(a, b)); }

  // Triangles without longer edges cover the mesh in no smaller number than equilateral ones.
  double LeastTriangles() const {
    constexpr double kEquilateral = 0.4330127;  // area by the square of the edge
    double count = 0;
    for (size_t i = 0; i < mesh_.indices.size(); i += 3) {
      const uint32_t* const v = &mesh_.indices[i];
      const Vec3 side = EdgeInRender(v[0], v[1]), other = EdgeInRender(v[1], v[2]);
      const Double3 twice = Cross(Double3(side), Double3(other));
      const double edge = std::max({static_cast<double>(displacement_.edge_length),
                                    ResolvedLength(v[0], v[1], side), ResolvedLength(v[1], v[2], other)});
      const double least = std::sqrt(Dot(twice, twice)) / 2 / (kEquilateral * edge * edge);
      if (std::isfinite(least)) count += least;
    }
    return count;
  }
  // The length, in rendering space, below which edges along (a, b) are not resolved.
  double ResolvedLength(uint32_t a, uint32_t b, Vec3 in_render) const {
    const Vec3 edge = mesh_.P[a] - mesh_.P[b], reach = Max(Abs(mesh_.P[a]), Abs(mesh_.P[b]));
    return static_cast<double>(Length(in_render)) * static_cast<double>(kUnresolved * MaxComponent(reach)) /
           static_cast<double>(Length(edge));
  }
  // Splits the longest edge while any is too long.
  bool Split(uint32_t v0, uint32_t v1, uint32_t v2, int depth) {
    const float d01 = EdgeLength(v0, v1), d12 = EdgeLength(v1, v2), d20 = EdgeLength(v2, v0);
    if (d01 > d12 && d01 > d20) return SplitAt(d01, v0, v1, v2, depth);
    if (d12 > d20) return SplitAt(d12, v1, v2, v0, depth);
    return SplitAt(d20, v2, v0, v1, depth);
  }
  // The edge (a, b) of length `longest` is the longest of the triangle (a, b, c).
  bool SplitAt(float longest, uint32_t a, uint32_t b, uint32_t c, int depth) {
    const Point3 middle = (mesh_.P[a] + mesh_.P[b]) * 0.5f;
    const bool can_split =
        !(middle == mesh_.P[a]) && !(middle == mesh_.P[b]) && IsResolved(a, b) && depth < kDepthMax;
    if (longest < displacement_.edge_length || !can_split) {
      mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
      constexpr size_t kBudgetInterval = 3 * 4096;
      if (mesh_.indices.size() % kBudgetInterval == 0) CheckLoadBudget();
      return mesh_.indices.size() / 3 <= kMadeTrianglesMax;
    }
    const uint32_t split = MiddleOf(a, b, middle);
    return Split(a, split, c, depth + 1) && Split(split, b, c, depth + 1);
  }
  // Whether floats hold the middle of an edge well enough for its halves to be shorter.
  bool IsResolved(uint32_t a, uint32_t b) const {
    const Point3 p = mesh_.P[a], q = mesh_.P[b];
    const Vec3 edge = Abs(p - q), reach = Max(Abs(p), Abs(q));
    return MaxComponent(edge) > kUnresolved * MaxComponent(reach);
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
                                displacement.edge_length, kMadeTrianglesMax));
  }
  for (size_t i = 0; i < mesh.P.size(); ++i) {
    const float height = displacement.height(mesh.P[i], mesh.N[i], mesh.uv[i]);
    mesh.P[i] = mesh.P[i] + mesh.N[i] * height;
  }
  mesh.N = NormalsOf(mesh);
  return mesh;
}

}  // namespace tessera
