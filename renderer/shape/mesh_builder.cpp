#include "renderer/shape/mesh_builder.h"

#include <utility>

namespace tessera {
namespace {

void Place(const Placement& placement, MeshData* lists) {
  const Transform& transform = placement.render_from_object;
  lists->P.reserve(lists->P.size() + 1);
  if (!transform.IsIdentity()) {
    for (Point3& p : lists->P) p = transform.ToPoint(p);
    for (Vec3& s : lists->S) s = transform.ToVector(s);
  }
  for (Normal3& n : lists->N) {
    n = transform.ToNormal(n);
    if (placement.reverse_orientation) n = -n;
    if (!IsFinite(n)) n = {};  // no normal: the geometric one is used
  }
}

template <typename T>
std::vector<T> Selected(const std::vector<T>& list, const std::vector<uint32_t>& selection) {
  std::vector<T> result;
  if (list.empty()) return result;
  result.reserve(selection.size() + 1);
  for (const uint32_t i : selection) result.push_back(list[i]);
  return result;
}

}  // namespace

TriangleMesh MakeTriangleMesh(MeshData lists, const Placement& placement) {
  Place(placement, &lists);
  return {std::move(lists.P),  std::move(lists.N),       std::move(lists.S),
          std::move(lists.uv), std::move(lists.indices), placement.FlipsNormals()};
}

BilinearMesh MakeBilinearMesh(MeshData lists, const Placement& placement) {
  Place(placement, &lists);
  return {std::move(lists.P), std::move(lists.N), std::move(lists.uv), std::move(lists.indices),
          placement.FlipsNormals()};
}

MeshData WithoutUnused(const MeshData& lists) {
  constexpr uint32_t kUnseen = 0xffffffffu;
  std::vector<uint32_t> new_index(lists.P.size(), kUnseen);
  std::vector<uint32_t> selection;
  MeshData result;
  result.indices.reserve(lists.indices.size());
  for (const uint32_t old : lists.indices) {
    if (new_index[old] == kUnseen) {
      new_index[old] = static_cast<uint32_t>(selection.size());
      selection.push_back(old);
    }
    result.indices.push_back(new_index[old]);
  }
  result.P = Selected(lists.P, selection);
  result.N = Selected(lists.N, selection);
  result.S = Selected(lists.S, selection);
  result.uv = Selected(lists.uv, selection);
  return result;
}

}  // namespace tessera
