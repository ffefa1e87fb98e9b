#include "renderer/material/coated_conductor_material.h"

namespace tessera {

CoatedConductorMaterial CoatedConductorMaterial::Read(MaterialReader& reader) {
  CoatedConductorMaterial material;
  material.metal = ConductorInput::Read(reader, "conductor.");
  material.metal_roughness = reader.Roughness("conductor.");
  material.coat_roughness = reader.Roughness("interface.");
  material.eta = reader.Eta("interface.eta");
  material.layer = CoatLayerInput::Read(reader);
  return material;
}

Bxdf CoatedConductorMaterial::MakeBxdf(const MaterialContext& at) const {
  const float eta_here = at(eta);
  const ConductorIndex index = metal.Evaluate(at);
  const SampledSpectrum inside(1 / eta_here);
  return LayeredConductorBxdf(DielectricBxdf(at(coat_roughness), eta_here), at(metal_roughness),
                              index.eta * inside, index.k * inside, layer.Evaluate(at));
}

}  // namespace tessera
