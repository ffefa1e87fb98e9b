// Matte surfaces under a clear coat: plastic, varnished wood, glazed tiles.
#pragma once

#include <memory>

#include "renderer/bxdf/bxdf.h"
#include "renderer/bxdf/coat_table.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: spectrum textures reflectance (0.5) of the base and albedo (0) of the layer, float or spectrum
// eta (1.5) of the coat, float textures thickness (0.01) and g (0), integer maxdepth (10) and nsamples (1);
// the roughness parameters of MaterialReader.
struct CoatedDiffuseMaterial {
  static constexpr int kLayerDepthMax = 1000;    // events of a walk between layers: more cannot be seen
  static constexpr int kLayerSamplesMax = 1024;  // walks per evaluation

  // Which parameter the coat's table runs over. kNone: there is no table, the layers are walked.
  enum class Table : uint8_t { kNone, kConstant, kAlpha, kEta };

  SpectrumInput reflectance, albedo;
  RoughnessInput roughness;
  EtaInput eta;
  FloatInput thickness, g;
  int depth_max = 10, sample_count = 1;
  Table table_kind = Table::kNone;
  std::shared_ptr<const CoatTable> table;  // shared by materials with the same coat

  static CoatedDiffuseMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return AnyTexture(reflectance, albedo, thickness, g, roughness); }
  Bxdf MakeBxdf(const MaterialContext& at) const;

 private:
  // Chooses and computes the table.
  void Prepare(CoatTableCache& cache);
};

}  // namespace tessera
