// Matte surfaces under a clear coat: plastic, varnished wood, glazed tiles.
#pragma once

#include <memory>

#include "renderer/bxdf/bxdf.h"
#include "renderer/bxdf/coat_table.h"
#include "renderer/material/coat_layer_input.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: spectrum texture reflectance (0.5) of the base, float or spectrum eta (1.5) of the coat, those
// of CoatLayerInput, and the roughness parameters of MaterialReader.
struct CoatedDiffuseMaterial {
  // Which parameter the coat's table runs over. kNone: there is no table, the layers are walked.
  enum class Table : uint8_t { kNone, kConstant, kAlpha, kEta };

  SpectrumInput reflectance;
  RoughnessInput roughness;
  EtaInput eta;
  CoatLayerInput layer;
  Table table_kind = Table::kNone;
  std::shared_ptr<const CoatTable> table;  // shared by materials with the same coat

  static CoatedDiffuseMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return AnyTexture(reflectance, layer, roughness); }
  bool IsIsotropic() const { return roughness.IsIsotropic(); }
  Bxdf MakeBxdf(const MaterialContext& at) const;

 private:
  // Chooses and computes the table.
  void Prepare(CoatTableCache& cache);
};

}  // namespace tessera
