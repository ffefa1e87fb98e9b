#include "renderer/material/measured_material.h"

#include <fmt/format.h>

namespace tessera {

MeasuredMaterial MeasuredMaterial::Read(MaterialReader& reader) {
  ParameterReader& parameters = reader.parameters;
  const std::optional<std::string> name = parameters.FindString("filename");
  if (!name) {
    parameters.Fail("material \"measured\" needs a parameter \"string filename\"");
    return {};
  }
  const auto brdf = reader.measured.Get(reader.textures.files(), *name);
  if (brdf) return {*brdf};
  parameters.FailAt("filename", fmt::format("measured BRDF \"{}\": {}", *name, brdf.error().message));
  return {};
}

}  // namespace tessera
