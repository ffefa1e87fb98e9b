#include "renderer/shape/shape_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "renderer/description/parameter_reader.h"
#include "renderer/shape/mesh_builder.h"
#include "renderer/shape/ply_reader.h"
#include "renderer/util/file.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

using Form = std::variant<TriangleMesh, BilinearMesh, Quadric>;

constexpr std::array<std::string_view, 8> kKinds{"sphere",       "cylinder", "disk",  "trianglemesh",
                                                 "bilinearmesh", "plymesh",  "curve", "loopsubdiv"};

// One directive on its way to its forms. Errors are the reader's.
struct Directive {
  ParameterReader& reader;
  MeshPlacement placement;
  FileSource& files;
  Diagnostics& diagnostics;

  void Warn(std::string_view parameter, const std::string& text) const {
    diagnostics.Warn(reader.LocationOf(parameter), text);
  }
};

// ---- Quadrics

float PhiMax(ParameterReader& reader) {
  const float degrees = std::clamp(reader.Float("phimax", 360), 0.0f, 360.0f);
  return degrees == 360 ? 2 * kPi : Radians(degrees);
}

Quadric ReadQuadric(const Directive& directive, Quadric::Kind kind) {
  ParameterReader& reader = directive.reader;
  const Transform& render_from_object = directive.placement.render_from_object;
  Quadric quadric;
  quadric.kind = kind;
  quadric.render_from_object = render_from_object;
  quadric.flip_normals = directive.placement.reverse_orientation != render_from_object.SwapsHandedness();
  quadric.radius = reader.Float("radius", 1);
  if (!(quadric.radius > 0)) reader.FailAt("radius", "radius must be above 0");
  if (kind == Quadric::Kind::kDisk) {
    quadric.z_min = quadric.z_max = reader.Float("height", 0);
    quadric.inner_radius = reader.Float("innerradius", 0);
  } else {
    const bool is_sphere = kind == Quadric::Kind::kSphere;
    const float z0 = reader.Float("zmin", is_sphere ? -quadric.radius : -1);
    const float z1 = reader.Float("zmax", is_sphere ? quadric.radius : 1);
    quadric.z_min = std::min(z0, z1);
    quadric.z_max = std::max(z0, z1);
    if (is_sphere && quadric.radius > 0) {
      quadric.z_min = std::clamp(quadric.z_min, -quadric.radius, quadric.radius);
      quadric.z_max = std::clamp(quadric.z_max, -quadric.radius, quadric.radius);
    }
  }
  quadric.phi_max = PhiMax(reader);
  return quadric;
}

// ---- Meshes written in the scene

template <typename T>
std::vector<T> MatchedToP(const Directive& directive, std::string_view name, std::vector<T> list,
                          size_t count) {
  if (list.empty() || list.size() == count) return list;
  directive.Warn(name, fmt::format("{} values of \"{}\" for {} points: ignored", list.size(), name, count));
  return {};
}

// Face indices belong to Ptex textures; nothing else asks for them.
std::vector<uint32_t> ReadIndices(const Directive& directive, size_t point_count, size_t per_face) {
  ParameterReader& reader = directive.reader;
  std::vector<int> given = reader.Integers("indices");
  reader.Integers("faceIndices");
  if (given.empty()) {
    if (point_count != per_face) {
      reader.Fail(fmt::format("{} needs \"integer indices\" unless it has just {} points",
                              reader.entity().kind, per_face));
    }
    for (size_t i = 0; i < per_face; ++i) given.push_back(static_cast<int>(i));
  }
  if (const size_t excess = given.size() % per_face; excess != 0) {
    directive.Warn("indices", fmt::format("{} indices are not a multiple of {}: the last {} {} ignored",
                                          given.size(), per_face, excess, excess == 1 ? "is" : "are"));
    given.resize(given.size() - excess);
  }
  if (given.empty()) reader.FailAt("indices", fmt::format("expected at least {} indices", per_face));
  for (const int index : given) {
    if (index >= 0 && static_cast<size_t>(index) < point_count) continue;
    reader.FailAt("indices",
                  fmt::format("index {} is out of range: \"P\" has {} points", index, point_count));
    break;
  }
  return {given.begin(), given.end()};
}

MeshLists ReadLists(const Directive& directive, size_t per_face, bool has_tangents) {
  ParameterReader& reader = directive.reader;
  MeshLists lists;
  lists.P = reader.Point3s("P");
  const size_t count = lists.P.size();
  if (count == 0) reader.Fail(fmt::format("{} needs \"point3 P\"", reader.entity().kind));
  lists.indices = ReadIndices(directive, count, per_face);
  lists.uv = MatchedToP(directive, "uv", reader.Point2s("uv"), count);
  lists.N = MatchedToP(directive, "N", reader.Normals("N"), count);
  if (has_tangents) lists.S = MatchedToP(directive, "S", reader.Vector3s("S"), count);
  return lists;
}

Form ReadTriangleMesh(const Directive& directive) {
  MeshLists lists = ReadLists(directive, 3, true);
  if (directive.reader.failed()) return TriangleMesh{};
  return MakeTriangleMesh(std::move(lists), directive.placement);
}

Form ReadBilinearMesh(const Directive& directive) {
  MeshLists lists = ReadLists(directive, 4, false);
  if (directive.reader.FindString("emissionfilename")) {
    directive.Warn("emissionfilename",
                   "\"emissionfilename\" only guides pbrt's sampling; it is not used here");
  }
  if (directive.reader.failed()) return BilinearMesh{};
  return MakeBilinearMesh(std::move(lists), directive.placement);
}

// ---- Meshes in files

bool IsGzip(std::string_view bytes) {
  return bytes.starts_with("\x1f\x8b");
}

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

// The file's vertices with these faces, with room for the one more that a mesh in rendering space has.
MeshLists ListsOf(const PlyMesh& ply, const std::vector<uint32_t>& indices) {
  MeshLists lists;
  lists.P.reserve(ply.P.size() + 1);
  lists.P = ply.P;
  lists.N = ply.N;
  lists.uv = ply.uv;
  lists.indices = indices;
  return lists;
}

std::vector<Form> MakeForms(const PlyMesh& ply, const MeshPlacement& placement) {
  std::vector<Form> forms;
  if (ply.quads.empty()) {
    forms.emplace_back(MakeTriangleMesh(ListsOf(ply, ply.triangles), placement));
    return forms;
  }
  if (!ply.triangles.empty()) {
    forms.emplace_back(MakeTriangleMesh(WithoutUnused(ListsOf(ply, ply.triangles)), placement));
  }
  MeshLists lists = ListsOf(ply, ply.quads);
  if (!forms.empty()) lists = WithoutUnused(lists);
  forms.emplace_back(MakeBilinearMesh(std::move(lists), placement));
  return forms;
}

std::vector<Form> ReadPlyMesh(const Directive& directive) {
  ParameterReader& reader = directive.reader;
  const std::string name = reader.String("filename", "");
  if (name.empty()) reader.Fail("plymesh needs \"string filename\"");
  if (reader.FindTexture("displacement")) reader.FailAt("displacement", "displacement is not supported yet");
  reader.Float("edgelength", 1);
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
  return MakeForms(ply, directive.placement);
}

// ---- All kinds

std::vector<Form> ReadForms(const Directive& directive) {
  const std::string& kind = directive.reader.entity().kind;
  std::vector<Form> forms;
  if (kind == "plymesh") {
    forms = ReadPlyMesh(directive);
  } else if (kind == "trianglemesh") {
    forms.push_back(ReadTriangleMesh(directive));
  } else if (kind == "bilinearmesh") {
    forms.push_back(ReadBilinearMesh(directive));
  } else if (kind == "sphere") {
    forms.emplace_back(ReadQuadric(directive, Quadric::Kind::kSphere));
  } else if (kind == "cylinder") {
    forms.emplace_back(ReadQuadric(directive, Quadric::Kind::kCylinder));
  } else if (kind == "disk") {
    forms.emplace_back(ReadQuadric(directive, Quadric::Kind::kDisk));
  } else if (std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end()) {
    directive.reader.Fail(fmt::format("shape \"{}\" is not supported yet", kind));
  } else {
    directive.reader.Fail(fmt::format("unknown shape \"{}\"{}", kind, DidYouMean(kind, kKinds)));
  }
  return forms;
}

// Whether what a transform made of the vertices is still in the range of float.
bool IsFinite(const Shape& shape) {
  const Bounds3 bounds = shape.Bounds();
  return tessera::IsFinite(bounds.min) && tessera::IsFinite(bounds.max);
}

}  // namespace

Result<std::vector<Shape>> BuildShape(const ShapeDescription& description, const Transform& render_from_world,
                                      FileSource& files, TextureBuilder& textures, Diagnostics& diagnostics) {
  const Entity& entity = description.entity;
  TESSERA_CHECK(!description.world_from_object.IsAnimated());
  ParameterReader reader(entity);
  const Transform render_from_object = render_from_world * description.world_from_object.start;
  const FloatInput alpha = textures.Float(reader, "alpha", 1);
  std::vector<Form> forms =
      ReadForms({reader, {render_from_object, description.reverse_orientation}, files, diagnostics});
  if (Result<void> done = reader.Finish(); !done) return done.error();
  std::vector<Shape> shapes;
  for (Form& form : forms) {
    Shape shape;
    shape.surface.alpha = alpha;
    shape.form = std::move(form);
    if (!IsFinite(shape)) return ErrorAt(entity.location, "the shape is not finite in rendering space");
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace tessera
