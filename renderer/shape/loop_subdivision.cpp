#include "renderer/shape/loop_subdivision.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "renderer/shape/made_triangles.h"
#include "renderer/util/load_budget.h"

namespace tessera {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

constexpr uint32_t Next(uint32_t corner) {
  return (corner + 1) % 3;
}
constexpr uint32_t Previous(uint32_t corner) {
  return (corner + 2) % 3;
}

// Edge k of a face goes from corner k to the next.
struct Face {
  std::array<uint32_t, 3> vertex{kNone, kNone, kNone};
  std::array<uint32_t, 3> neighbor{kNone, kNone, kNone};  // across edge k; kNone at a boundary

  uint32_t CornerOf(uint32_t v) const { return vertex[0] == v ? 0 : vertex[1] == v ? 1 : 2; }
};

// Vertices around a vertex, in order: clockwise around an inner one, as seen from the front, and
// counterclockwise from boundary to boundary. Empty if no triangle has the vertex.
struct Ring {
  std::vector<Point3> points;
  bool is_boundary = false;

  size_t valence() const { return points.size(); }
};

struct Mesh {
  std::vector<Point3> P;
  std::vector<Face> faces;
  std::vector<uint32_t> start_face;  // of each vertex: any that has it, or kNone

  // Across the edge that starts (ends) at the vertex.
  uint32_t FaceAfter(uint32_t face, uint32_t v) const {
    return faces[face].neighbor[faces[face].CornerOf(v)];
  }
  uint32_t FaceBefore(uint32_t face, uint32_t v) const {
    return faces[face].neighbor[Previous(faces[face].CornerOf(v))];
  }
  Point3 PointAfter(uint32_t face, uint32_t v) const {
    return P[faces[face].vertex[Next(faces[face].CornerOf(v))]];
  }
  Point3 PointBefore(uint32_t face, uint32_t v) const {
    return P[faces[face].vertex[Previous(faces[face].CornerOf(v))]];
  }
  void FillRing(uint32_t v, Ring* ring) const;
};

void Mesh::FillRing(uint32_t v, Ring* ring) const {
  ring->points.clear();
  ring->is_boundary = false;
  const uint32_t start = start_face[v];
  if (start == kNone) return;
  uint32_t face = start, last;
  do {
    ring->points.push_back(PointAfter(face, v));
    last = face;
    face = FaceAfter(face, v);
  } while (face != kNone && face != start);
  ring->is_boundary = face == kNone;
  if (!ring->is_boundary) return;
  ring->points.assign(1, PointAfter(last, v));
  for (face = last; face != kNone; face = FaceBefore(face, v)) ring->points.push_back(PointBefore(face, v));
}

// An edge of a face, to be paired with that of its neighbour.
struct HalfEdge {
  uint32_t low, high;  // vertices
  uint32_t face, edge;
};

std::vector<HalfEdge> SortedHalfEdges(const std::vector<Face>& faces) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * faces.size());
  for (uint32_t f = 0; f < faces.size(); ++f) {
    for (uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces[f].vertex[k], faces[f].vertex[Next(k)]);
      edges.push_back({low, high, f, k});
    }
  }
  std::ranges::sort(edges, {}, [](const HalfEdge& e) { return std::array{e.low, e.high, e.face, e.edge}; });
  return edges;
}

Result<void> FindNeighbors(std::vector<Face>* faces) {
  const std::vector<HalfEdge> edges = SortedHalfEdges(*faces);
  for (size_t i = 0; i < edges.size();) {
    const HalfEdge& a = edges[i];
    size_t end = i + 1;
    while (end < edges.size() && edges[end].low == a.low && edges[end].high == a.high) ++end;
    if (end - i > 2) {
      return BadInput(
          fmt::format("triangles {}, {} and {} share the edge of points {} and {}; at most two may", a.face,
                      edges[i + 1].face, edges[i + 2].face, a.low, a.high));
    }
    if (end - i == 2) {
      const HalfEdge& b = edges[i + 1];
      if ((*faces)[a.face].vertex[a.edge] == (*faces)[b.face].vertex[b.edge]) {
        return BadInput(
            fmt::format("triangles {} and {} run along the edge of points {} and {} in the same "
                        "direction; neighbours must have the same orientation",
                        a.face, b.face, a.low, a.high));
      }
      (*faces)[a.face].neighbor[a.edge] = b.face;
      (*faces)[b.face].neighbor[b.edge] = a.face;
    }
    i = end;
  }
  return {};
}

Result<Mesh> Connect(const MeshData& control) {
  Mesh mesh;
  mesh.P = control.P;
  mesh.faces.resize(control.indices.size() / 3);
  mesh.start_face.assign(mesh.P.size(), kNone);
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t v = control.indices[3 * size_t{f} + k];
      mesh.faces[f].vertex[k] = v;
      mesh.start_face[v] = f;
    }
    const auto [a, b, c] = mesh.faces[f].vertex;
    if (a == b || b == c || c == a) return BadInput(fmt::format("triangle {} has a point twice", f));
  }
  if (Result<void> found = FindNeighbors(&mesh.faces); !found) return found.error();
  return mesh;
}

Point3 Sum(std::span<const Point3> points) {
  Point3 sum;
  for (const Point3 p : points) sum += p;
  return sum;
}

// A weighted mean of the vertex and its ring: `beta` of each neighbour.
Point3 WeightRing(Point3 p, const Ring& ring, float beta) {
  return p * (1 - static_cast<float>(ring.valence()) * beta) + Sum(ring.points) * beta;
}
// The same with its neighbours along the boundary.
Point3 WeightBoundary(Point3 p, const Ring& ring, float beta) {
  return p * (1 - 2 * beta) + (ring.points.front() + ring.points.back()) * beta;
}

float LoopBeta(size_t valence) {
  return valence == 3 ? 3.0f / 16 : 3 / (8 * static_cast<float>(valence));
}

Point3 RefinedPoint(Point3 p, const Ring& ring) {
  if (ring.points.empty()) return p;
  return ring.is_boundary ? WeightBoundary(p, ring, 1.0f / 8) : WeightRing(p, ring, LoopBeta(ring.valence()));
}
// On the boundary with pbrt's weights; those of the limit curve would be 1/6.
Point3 LimitPoint(Point3 p, const Ring& ring) {
  if (ring.points.empty()) return p;
  if (ring.is_boundary) return WeightBoundary(p, ring, 1.0f / 5);
  const float gamma = 1 / (static_cast<float>(ring.valence()) + 3 / (8 * LoopBeta(ring.valence())));
  return WeightRing(p, ring, gamma);
}

// The point in the middle of edge k of a face.
Point3 EdgePoint(const Mesh& mesh, uint32_t face, uint32_t k) {
  const Face& f = mesh.faces[face];
  const uint32_t a = f.vertex[k], b = f.vertex[Next(k)];
  if (f.neighbor[k] == kNone) return (mesh.P[a] + mesh.P[b]) * 0.5f;
  // The neighbour runs along the edge from b to a.
  const Point3 opposite = mesh.P[f.vertex[Previous(k)]], beyond = mesh.PointBefore(f.neighbor[k], b);
  return (mesh.P[a] + mesh.P[b]) * (3.0f / 8) + (opposite + beyond) * (1.0f / 8);
}

// Adds the points in the middle of the edges to `points`. Returns the index of each, three for each face.
std::vector<std::array<uint32_t, 3>> AddEdgePoints(const Mesh& mesh, std::vector<Point3>* points) {
  std::vector<std::array<uint32_t, 3>> middle(mesh.faces.size());
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = mesh.faces[f];
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t neighbor = face.neighbor[k];
      if (neighbor < f) {
        middle[f][k] = middle[neighbor][mesh.faces[neighbor].CornerOf(face.vertex[Next(k)])];
        continue;
      }
      middle[f][k] = static_cast<uint32_t>(points->size());
      points->push_back(EdgePoint(mesh, f, k));
    }
  }
  return middle;
}

// Face f becomes 4 f + k at corner k, and 4 f + 3 in the middle, whose corner k is in the middle of edge k.
void SplitFace(const Mesh& mesh, uint32_t f, const std::array<uint32_t, 3>& middle,
               std::vector<Face>* faces) {
  const Face& face = mesh.faces[f];
  const uint32_t first = 4 * f;
  Face& inner = (*faces)[first + 3];
  inner.vertex = middle;
  for (uint32_t k = 0; k < 3; ++k) {
    Face& corner = (*faces)[first + k];
    corner.vertex[k] = face.vertex[k];
    corner.vertex[Next(k)] = middle[k];
    corner.vertex[Previous(k)] = middle[Previous(k)];
    const auto child_of = [&](uint32_t neighbor) {
      return neighbor == kNone ? kNone : 4 * neighbor + mesh.faces[neighbor].CornerOf(face.vertex[k]);
    };
    corner.neighbor[k] = child_of(face.neighbor[k]);
    corner.neighbor[Previous(k)] = child_of(face.neighbor[Previous(k)]);
    corner.neighbor[Next(k)] = first + 3;
    inner.neighbor[k] = first + Next(k);
  }
}

Mesh Refine(const Mesh& mesh) {
  Mesh refined;
  Ring ring;
  refined.P.reserve(mesh.P.size() + 3 * mesh.faces.size() / 2 + 1);
  for (uint32_t v = 0; v < mesh.P.size(); ++v) {
    mesh.FillRing(v, &ring);
    refined.P.push_back(RefinedPoint(mesh.P[v], ring));
  }
  const std::vector<std::array<uint32_t, 3>> middle = AddEdgePoints(mesh, &refined.P);
  refined.faces.resize(4 * mesh.faces.size());
  refined.start_face.resize(refined.P.size());
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    SplitFace(mesh, f, middle[f], &refined.faces);
    for (const uint32_t v : middle[f]) refined.start_face[v] = 4 * f + 3;
  }
  for (uint32_t v = 0; v < mesh.P.size(); ++v) {
    const uint32_t face = mesh.start_face[v];
    refined.start_face[v] = face == kNone ? kNone : 4 * face + mesh.faces[face].CornerOf(v);
  }
  return refined;
}

// The direction in which the surface leaves its boundary (Hoppe et al. 1994).
Vec3 BoundaryTangent(Point3 p, const std::vector<Point3>& ring) {
  const size_t valence = ring.size();
  if (valence == 2) return ring[0] + ring[1] - p * 2;
  if (valence == 3) return ring[1] - p;
  if (valence == 4) return (ring[1] + ring[2]) * 2 - ring[0] - ring[3] - p * 2;
  const float theta = kPi / static_cast<float>(valence - 1);
  Vec3 tangent = (ring.front() + ring.back()) * std::sin(theta);
  for (size_t k = 1; k + 1 < valence; ++k)
    tangent += ring[k] * ((2 * std::cos(theta) - 2) * std::sin(static_cast<float>(k) * theta));
  return -tangent;
}

// Of the limit surface. `ring` holds points of the limit, as pbrt takes them, and not those before it, which
// would be exact; the difference vanishes with the number of levels.
Normal3 LimitNormal(Point3 p, const Ring& ring) {
  if (ring.is_boundary)
    return Cross(ring.points.back() - ring.points.front(), BoundaryTangent(p, ring.points));
  Vec3 s, t;
  for (size_t j = 0; j < ring.valence(); ++j) {
    const float angle = 2 * kPi * static_cast<float>(j) / static_cast<float>(ring.valence());
    s += ring.points[j] * std::cos(angle);
    t += ring.points[j] * std::sin(angle);
  }
  return Cross(s, t);
}

MeshData TakeToLimit(Mesh mesh) {
  MeshData result;
  Ring ring;
  result.P.reserve(mesh.P.size() + 1);
  for (uint32_t v = 0; v < mesh.P.size(); ++v) {
    mesh.FillRing(v, &ring);
    result.P.push_back(LimitPoint(mesh.P[v], ring));
  }
  mesh.P = result.P;
  result.N.reserve(mesh.P.size());
  for (uint32_t v = 0; v < mesh.P.size(); ++v) {
    mesh.FillRing(v, &ring);
    result.N.push_back(LimitNormal(mesh.P[v], ring));
  }
  result.indices.reserve(3 * mesh.faces.size());
  for (const Face& face : mesh.faces)
    result.indices.insert(result.indices.end(), face.vertex.begin(), face.vertex.end());
  return result;
}

}  // namespace

Result<MeshData> SubdivideLoop(const MeshData& control, int levels) {
  uint64_t triangles = control.indices.size() / 3;
  for (int i = 0; i < levels && triangles <= kMadeTrianglesMax; ++i) triangles *= 4;
  if (triangles > kMadeTrianglesMax)
    return BadInput(fmt::format("{} levels make more than {} triangles", levels, kMadeTrianglesMax));
  Result<Mesh> mesh = Connect(control);
  if (!mesh) return mesh.error();
  for (int i = 0; i < levels; ++i) {
    CheckLoadBudget();
    *mesh = Refine(*mesh);
  }
  return TakeToLimit(*std::move(mesh));
}

}  // namespace tessera
