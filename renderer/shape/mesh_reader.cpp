#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "renderer/shape/shape_directive.h"

namespace tessera {
namespace {

template <typename T>
std::vector<T> MatchedToP(const ShapeDirective& directive, std::string_view name, std::vector<T> list,
                          size_t count) {
  if (list.empty() || list.size() == count) return list;
  directive.Warn(
      name, fmt::format("\"{1}\" is ignored: it has {0} values for {2} points", list.size(), name, count));
  return {};
}

// Face indices are used by Ptex textures only. Empty, with a warning, if the mesh has to be left out.
std::vector<uint32_t> ReadIndices(const ShapeDirective& directive, size_t point_count, size_t per_face) {
  ParameterReader& reader = directive.reader;
  std::vector<int> given = reader.Integers("indices");
  reader.Integers("faceIndices");
  if (given.empty()) {
    if (point_count != per_face) {
      directive.Warn(
          "P", fmt::format("the {} is ignored: it needs \"integer indices\" unless it has just {} points",
                           reader.entity().kind, per_face));
      return {};
    }
    for (size_t i = 0; i < per_face; ++i) given.push_back(static_cast<int>(i));
  }
  if (const size_t excess = given.size() % per_face; excess != 0) {
    directive.Warn("indices", fmt::format("{} indices are not a multiple of {}; the last {} {} ignored",
                                          given.size(), per_face, excess, excess == 1 ? "is" : "are"));
    given.resize(given.size() - excess);
  }
  for (const int index : given) {
    if (index >= 0 && static_cast<size_t>(index) < point_count) continue;
    directive.Warn("indices", fmt::format("the {} is ignored: index {} is out of range, \"P\" has {} points",
                                          reader.entity().kind, index, point_count));
    return {};
  }
  return {given.begin(), given.end()};
}

MeshData ReadLists(const ShapeDirective& directive, size_t per_face, bool has_tangents) {
  ParameterReader& reader = directive.reader;
  MeshData lists;
  lists.P = reader.Point3s("P");
  const size_t count = lists.P.size();
  lists.indices = ReadIndices(directive, count, per_face);
  lists.uv = MatchedToP(directive, "uv", reader.Point2s("uv"), count);
  lists.N = MatchedToP(directive, "N", reader.Normals("N"), count);
  if (has_tangents) lists.S = MatchedToP(directive, "S", reader.Vector3s("S"), count);
  return lists;
}

// The mesh that the description holds as a value.
MeshData CheckedMesh(const ShapeDirective& directive, size_t per_face) {
  const MeshData& mesh = *directive.mesh;
  ParameterReader& reader = directive.reader;
  const size_t count = mesh.P.size();
  if (mesh.indices.empty() || mesh.indices.size() % per_face != 0) {
    reader.Fail(
        fmt::format("the mesh has {} indices, expected a multiple of {}", mesh.indices.size(), per_face));
  }
  const auto beyond = std::ranges::find_if(mesh.indices, [&](uint32_t index) { return index >= count; });
  if (beyond != mesh.indices.end())
    reader.Fail(fmt::format("index {} of the mesh is out of range: it has {} points", *beyond, count));
  const auto check = [&](std::string_view name, size_t size) {
    if (size != 0 && size != count)
      reader.Fail(fmt::format("the mesh has {} points but {} \"{}\"", count, size, name));
  };
  check("N", mesh.N.size());
  check("S", mesh.S.size());
  check("uv", mesh.uv.size());
  return mesh;
}

MeshData MeshOf(const ShapeDirective& directive, size_t per_face, bool has_tangents) {
  return directive.mesh != nullptr ? CheckedMesh(directive, per_face)
                                   : ReadLists(directive, per_face, has_tangents);
}

}  // namespace

std::vector<Form> ReadTriangleMesh(const ShapeDirective& directive) {
  MeshData lists = MeshOf(directive, 3, true);
  std::vector<Form> forms;
  if (!directive.reader.failed() && !lists.indices.empty())
    forms.emplace_back(MakeTriangleMesh(std::move(lists), directive.placement));
  return forms;
}

std::vector<Form> ReadBilinearMesh(const ShapeDirective& directive) {
  MeshData lists = MeshOf(directive, 4, false);
  if (directive.reader.FindString("emissionfilename")) {
    directive.Warn("emissionfilename",
                   "\"emissionfilename\" only guides pbrt's sampling; it is not used here");
  }
  std::vector<Form> forms;
  if (!directive.reader.failed() && !lists.indices.empty())
    forms.emplace_back(MakeBilinearMesh(std::move(lists), directive.placement));
  return forms;
}

}  // namespace tessera
