#include "renderer/material/diffuse_transmission_material.h"

namespace tessera {

DiffuseTransmissionMaterial DiffuseTransmissionMaterial::Read(MaterialReader& reader) {
  DiffuseTransmissionMaterial material;
  material.reflectance = reader.Albedo("reflectance", 0.25f);
  material.transmittance = reader.Albedo("transmittance", 0.25f);
  material.scale = reader.parameters.Float("scale", 1);
  return material;
}

Bxdf DiffuseTransmissionMaterial::MakeBxdf(const MaterialContext& at) const {
  return DiffuseTransmissionBxdf(Clamp(at(reflectance) * scale, 0, 1),
                                 Clamp(at(transmittance) * scale, 0, 1));
}

}  // namespace tessera
