#include <fmt/format.h>

#include <utility>

#include "renderer/shape/loop_subdivision.h"
#include "renderer/shape/shape_directive.h"

namespace tessera {
namespace {

MeshData ReadControlMesh(const ShapeDirective& directive) {
  ParameterReader& reader = directive.reader;
  MeshData control;
  control.P = reader.Point3s("P");
  std::vector<int> indices = reader.Integers("indices");
  if (control.P.empty()) reader.Fail("loopsubdiv needs \"point3 P\"");
  if (indices.empty()) reader.Fail("loopsubdiv needs \"integer indices\"");
  if (const size_t excess = indices.size() % 3; excess != 0) {
    directive.Warn("indices", fmt::format("{} indices are not a multiple of 3; the last {} {} ignored",
                                          indices.size(), excess, excess == 1 ? "is" : "are"));
    indices.resize(indices.size() - excess);
  }
  control.indices.reserve(indices.size());
  for (const int index : indices) {
    if (index < 0 || static_cast<size_t>(index) >= control.P.size()) {
      reader.FailAt("indices",
                    fmt::format("index {} is out of range: \"P\" has {} points", index, control.P.size()));
      break;
    }
    control.indices.push_back(static_cast<uint32_t>(index));
  }
  return control;
}

}  // namespace

std::vector<Form> ReadLoopSubdivision(const ShapeDirective& directive) {
  ParameterReader& reader = directive.reader;
  const MeshData control = ReadControlMesh(directive);
  const int levels = reader.Integer("levels", 3);
  if (levels < 0) reader.FailAt("levels", "levels must not be negative");
  reader.String("scheme", "loop");  // pbrt reads it and knows no other
  std::vector<Form> forms;
  if (reader.failed()) return forms;
  const Result<MeshData> mesh = SubdivideLoop(control, levels);
  if (!mesh) {
    reader.FailAt("indices", mesh.error().message);
    return forms;
  }
  forms.emplace_back(MakeTriangleMesh(WithoutUnused(*mesh), directive.placement));
  return forms;
}

}  // namespace tessera
