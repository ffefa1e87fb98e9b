// What a kind of material reads itself from: the parameters of one Material directive, and what they refer
// to.
#pragma once

#include <string>
#include <string_view>

#include "renderer/bssrdf/profile_cache.h"
#include "renderer/bxdf/coat_table.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/description/scene_description.h"
#include "renderer/material/material_inputs.h"
#include "renderer/material/measured_brdf_cache.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

// Errors are remembered by `parameters`; after an error the values that are returned have no meaning.
struct MaterialReader {
  static constexpr float kEtaMax = 1000;  // no medium is near it; keeps 1 / eta^2 representable

  ParameterReader& parameters;
  TextureBuilder& textures;
  CoatTableCache& coats;
  MeasuredBrdfCache& measured;
  ProfileCache& profiles;
  const SceneDescription& scene;
  int index;  // of the material in scene.materials

  // A spectrum in [0, 1] or a texture, the same at all wavelengths by default.
  SpectrumInput Albedo(std::string_view name, float default_value);
  FloatInput Float(std::string_view name, float default_value);
  // The parameters PREFIXuroughness, PREFIXvroughness, PREFIXroughness, and remaproughness without a prefix.
  RoughnessInput Roughness(const std::string& prefix = "");
  // The parameter `name`, a number or a spectrum.
  EtaInput Eta(std::string_view name = "eta");
};

}  // namespace tessera
