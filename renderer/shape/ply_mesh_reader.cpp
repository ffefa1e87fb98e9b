#include <fmt/format.h>

#include <memory>
#include <utility>

#include "renderer/shape/displaced_mesh.h"
#include "renderer/shape/ply_reader.h"
#include "renderer/shape/shape_directive.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

uint64_t BytesOf(const PlyMesh& mesh) {
  return sizeof mesh + mesh.P.size() * sizeof(Point3) + mesh.N.size() * sizeof(Normal3) +
         mesh.uv.size() * sizeof(Point2) + (mesh.triangles.size() + mesh.quads.size()) * sizeof(uint32_t);
}

Result<std::shared_ptr<const PlyMesh>> ReadPlyFile(const std::string& name, FileSource& files) {
  if (auto known = files.Recall<PlyMesh>(name, "ply")) return known;
  Result<std::string> bytes = files.Read(name);
  if (bytes && IsGzip(*bytes)) bytes = Gunzip(*bytes, name, kSceneFileSizeMax);
  if (!bytes) return bytes.error();
  Result<PlyMesh> mesh = ReadPly(*bytes, name);
  if (!mesh) return mesh.error();
  auto shared = std::make_shared<const PlyMesh>(std::move(*mesh));
  files.Keep(name, "ply", shared, BytesOf(*shared));
  return shared;
}

// The file's vertices with these faces, with room for one more vertex as MakeTriangleMesh leaves it.
MeshData ListsOf(const PlyMesh& ply, const std::vector<uint32_t>& indices) {
  MeshData lists;
  lists.P.reserve(ply.P.size() + 1);
  lists.P = ply.P;
  lists.N = ply.N;
  lists.uv = ply.uv;
  lists.indices = indices;
  return lists;
}

std::vector<Form> MakeForms(const PlyMesh& ply, const Placement& placement) {
  std::vector<Form> forms;
  if (ply.quads.empty()) {
    forms.emplace_back(MakeTriangleMesh(ListsOf(ply, ply.triangles), placement));
    return forms;
  }
  if (!ply.triangles.empty()) {
    forms.emplace_back(MakeTriangleMesh(WithoutUnused(ListsOf(ply, ply.triangles)), placement));
  }
  MeshData lists = ListsOf(ply, ply.quads);
  if (!forms.empty()) lists = WithoutUnused(lists);
  forms.emplace_back(MakeBilinearMesh(std::move(lists), placement));
  return forms;
}

// Quads become two triangles each.
MeshData TrianglesOf(const PlyMesh& ply) {
  MeshData lists = ListsOf(ply, ply.triangles);
  for (size_t i = 0; i < ply.quads.size(); i += 4) {
    const uint32_t* q = &ply.quads[i];
    lists.indices.insert(lists.indices.end(), {q[0], q[1], q[3], q[0], q[3], q[2]});
  }
  return lists;
}

// Constants are not accepted, as in pbrt.
std::optional<FloatInput> ReadDisplacement(const ShapeDirective& directive) {
  if (!directive.reader.FindTexture("displacement")) return std::nullopt;
  return directive.textures.FindFloat(directive.reader, "displacement");
}

// Reports errors to the reader; the result is then ignored.
std::vector<Form> MakeDisplaced(const PlyMesh& ply, const FloatInput& height, float edge_length,
                                const ShapeDirective& directive) {
  if (ply.uv.empty()) {
    directive.reader.FailAt("displacement", "displacement needs a mesh with texture coordinates");
    return {};
  }
  const Transform& transform = directive.placement.render_from_object;
  const TextureTable textures = directive.textures.Snapshot();
  const auto height_at = [&](Point3 p, Normal3 n, Point2 uv) {
    TextureContext place;
    place.p = transform.ToPoint(p);
    place.n = transform.ToNormal(n);
    place.uv = uv;
    return textures.Evaluate(height, place);
  };
  Result<MeshData> displaced = Displace(TrianglesOf(ply), {edge_length, transform, height_at});
  if (!displaced) {
    directive.reader.FailAt("edgelength", displaced.error().message);
    return {};
  }
  std::vector<Form> forms;
  forms.emplace_back(MakeTriangleMesh(std::move(*displaced), directive.placement));
  return forms;
}

}  // namespace

std::vector<Form> ReadPlyMesh(const ShapeDirective& directive) {
  ParameterReader& reader = directive.reader;
  const std::string name = reader.String("filename", "");
  if (name.empty()) reader.Fail("plymesh needs \"string filename\"");
  const std::optional<FloatInput> displacement = ReadDisplacement(directive);
  const float edge_length = reader.Float("edgelength", 1);
  if (displacement && !(edge_length > 0)) reader.FailAt("edgelength", "edgelength must be above 0");
  if (reader.failed()) return {};
  const Result<std::shared_ptr<const PlyMesh>> read = ReadPlyFile(name, directive.files);
  if (!read) {
    const SourceLocation where = reader.LocationOf("filename");
    reader.Fail(Error{read.error().kind, where.Text() + ": " + read.error().message});
    return {};
  }
  const PlyMesh& ply = **read;
  if (ply.skipped_faces > 0) {
    directive.Warn("filename", fmt::format("{}: {} faces of neither three nor four vertices are ignored",
                                           name, ply.skipped_faces));
  }
  if (displacement) return MakeDisplaced(ply, *displacement, edge_length, directive);
  return MakeForms(ply, directive.placement);
}

}  // namespace tessera
