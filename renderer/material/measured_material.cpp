#include "renderer/material/measured_material.h"

#include <fmt/format.h>

#include "renderer/material/measured_brdf_file.h"

namespace tessera {
namespace {

// Kept with the files, for the other frames of a sequence.
constexpr const char* kWhat = "measured BRDF";

}  // namespace

MeasuredMaterial MeasuredMaterial::Read(MaterialReader& reader) {
  MeasuredMaterial material;
  ParameterReader& parameters = reader.parameters;
  const std::optional<std::string> name = parameters.FindString("filename");
  if (!name) {
    parameters.Fail("material \"measured\" needs a parameter \"string filename\"");
    return material;
  }
  FileSource& files = reader.textures.files();
  material.brdf = files.Recall<MeasuredBrdf>(*name, kWhat);
  if (material.brdf) return material;
  const auto fail = [&](const std::string& problem) {
    parameters.FailAt("filename", fmt::format("measured BRDF \"{}\": {}", *name, problem));
    return material;
  };
  const Result<std::string> bytes = files.Read(*name);
  if (!bytes) return fail(bytes.error().message);
  Result<MeasuredBrdf> brdf = ReadMeasuredBrdf(*bytes);
  if (!brdf) return fail(brdf.error().message);
  material.brdf = std::make_shared<const MeasuredBrdf>(std::move(*brdf));
  files.Keep(*name, kWhat, material.brdf, 3 * bytes->size());
  return material;
}

}  // namespace tessera
