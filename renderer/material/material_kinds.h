// The kinds of material: the inputs of each, as they are kept once a scene is built.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "renderer/material/bxdf.h"
#include "renderer/material/coat_table.h"
#include "renderer/material/normal_map.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Roughness along u and v. Constant ones are made into a distribution once.
struct RoughnessInput {
  FloatInput u, v;
  bool remap = true;  // alpha is the square root of the value; else the value itself
  bool is_constant = true;
  MicrofacetDistribution constant;

  // Sets is_constant and constant from the rest.
  void Prepare();
  bool IsIsotropic() const { return u.texture == v.texture && (u.texture >= 0 || u.constant == v.constant); }
  MicrofacetDistribution Evaluate(const TextureTable& textures, const TextureContext& context) const {
    return is_constant ? constant : EvaluateTextures(textures, context);
  }

 private:
  MicrofacetDistribution FromValues(float value_u, float value_v) const;
  MicrofacetDistribution EvaluateTextures(const TextureTable& textures, const TextureContext& context) const;
};

// The index of refraction of an interface, below over above.
struct EtaInput {
  Spectrum spectrum = Spectrum::Constant(1.5f);
  bool disperses = false;
  float constant = 1.5f;

  static EtaInput From(const Spectrum& spectrum);
  // At the first wavelength; drops the others if they would be bent differently.
  float Evaluate(SampledWavelengths& wavelengths) const {
    if (!disperses) return constant;
    wavelengths.TerminateSecondary();
    return ValueAt(wavelengths.lambda[0]);
  }
  // lambda in nm. 1 where the spectrum has no samples.
  float ValueAt(float lambda) const;
};

struct InterfaceMaterial {};

struct DiffuseMaterial {
  SpectrumInput reflectance;
};

struct DiffuseTransmissionMaterial {
  SpectrumInput reflectance, transmittance;
  float scale = 1;
};

struct ConductorMaterial {
  bool has_reflectance = false;  // then `eta` is the reflectance at normal incidence and `k` is unused
  SpectrumInput eta, k;
  RoughnessInput roughness;
};

struct DielectricMaterial {
  EtaInput eta;
  RoughnessInput roughness;
};

struct ThinDielectricMaterial {
  EtaInput eta;
};

struct CoatedDiffuseMaterial {
  // Which parameter the coat's table runs over. kNone: there is no table, the layers are walked.
  enum class Table : uint8_t { kNone, kConstant, kAlpha, kEta };

  SpectrumInput reflectance, albedo;
  RoughnessInput roughness;
  EtaInput eta;
  FloatInput thickness, g;
  int depth_max = 10, sample_count = 1;
  Table table_kind = Table::kNone;
  std::shared_ptr<const CoatTable> table;  // shared by materials with the same coat

  // Chooses and makes the table.
  void Prepare(CoatTableCache& cache);
};

struct MixMaterial {
  int first = 0, second = 0;  // indices of materials, both smaller than that of a named mix
  FloatInput amount;          // 0: first, 1: second
  uint64_t names_hash = 0;    // of the names of both
};

struct Material {
  std::variant<InterfaceMaterial, DiffuseMaterial, DiffuseTransmissionMaterial, ConductorMaterial,
               DielectricMaterial, ThinDielectricMaterial, CoatedDiffuseMaterial, MixMaterial>
      kind;
  std::optional<FloatInput> displacement;
  std::shared_ptr<const NormalMap> normal_map;  // goes before displacement
};

}  // namespace tessera
