// A Shape directive on its way to its forms, and the readers of the kinds. To add a kind, declare its reader
// here and give it a row in shape_kinds.cpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/shape/form.h"
#include "renderer/shape/mesh_builder.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

struct ShapeDirective {
  ParameterReader& reader;
  Placement placement;
  FileSource& files;
  Diagnostics& diagnostics;
  TextureBuilder& textures;
  const MeshData* mesh = nullptr;  // of a kind that is a mesh; null: the parameters give it

  void Warn(std::string_view parameter, const std::string& text) const {
    diagnostics.Warn(reader.LocationOf(parameter), text);
  }
};

// The forms of one directive. Reports errors to the reader; the result is then ignored.
using ShapeReader = std::vector<Form> (*)(const ShapeDirective& directive);

std::vector<Form> ReadSphere(const ShapeDirective& directive);
std::vector<Form> ReadCylinder(const ShapeDirective& directive);
std::vector<Form> ReadDisk(const ShapeDirective& directive);
std::vector<Form> ReadTriangleMesh(const ShapeDirective& directive);
std::vector<Form> ReadBilinearMesh(const ShapeDirective& directive);
std::vector<Form> ReadCurve(const ShapeDirective& directive);
std::vector<Form> ReadLoopSubdivision(const ShapeDirective& directive);
std::vector<Form> ReadPlyMesh(const ShapeDirective& directive);

}  // namespace tessera
