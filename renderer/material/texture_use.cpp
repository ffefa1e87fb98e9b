#include "renderer/material/texture_use.h"

namespace tessera {
namespace {

template <typename... Inputs>
bool AnyTexture(const Inputs&... inputs) {
  return (!inputs.IsConstant() || ...);
}

bool Reads(const RoughnessInput& roughness) {
  return AnyTexture(roughness.u, roughness.v);
}
bool Reads(const InterfaceMaterial&) {
  return false;
}
bool Reads(const DiffuseMaterial& m) {
  return AnyTexture(m.reflectance);
}
bool Reads(const DiffuseTransmissionMaterial& m) {
  return AnyTexture(m.reflectance, m.transmittance);
}
bool Reads(const ConductorMaterial& m) {
  return AnyTexture(m.eta, m.k) || Reads(m.roughness);
}
bool Reads(const DielectricMaterial& m) {
  return Reads(m.roughness);
}
bool Reads(const ThinDielectricMaterial&) {
  return false;
}
bool Reads(const CoatedDiffuseMaterial& m) {
  return AnyTexture(m.reflectance, m.albedo, m.thickness, m.g) || Reads(m.roughness);
}
bool Reads(const MixMaterial& m) {
  return AnyTexture(m.amount);
}

}  // namespace

bool ReadsTextures(const Material& material) {
  if (material.displacement || material.normal_map) return true;
  return std::visit([](const auto& kind) { return Reads(kind); }, material.kind);
}

}  // namespace tessera
