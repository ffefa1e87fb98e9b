// From the Material directives of a scene to materials.
#pragma once

#include <vector>

#include "renderer/description/parameter_reader.h"
#include "renderer/material/material_kinds.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

class MaterialBuilder {
 public:
  static constexpr int kLayerDepthMax = 1000;    // events of a walk between layers: more cannot be seen
  static constexpr int kLayerSamplesMax = 1024;  // walks per evaluation
  static constexpr float kEtaMax = 1000;         // no medium is near it; keeps 1 / eta^2 representable

  // Both must outlive the builder.
  MaterialBuilder(const SceneDescription& scene, TextureBuilder& textures)
      : scene_(scene), textures_(textures) {}

  // The material of scene.materials[index].
  Result<Material> Build(int index);

 private:
  Result<Material> BuildKind(const std::string& kind, int index, ParameterReader& reader);
  DiffuseMaterial Diffuse(ParameterReader& reader);
  DiffuseTransmissionMaterial DiffuseTransmission(ParameterReader& reader);
  ConductorMaterial Conductor(ParameterReader& reader);
  CoatedDiffuseMaterial CoatedDiffuse(ParameterReader& reader);
  MixMaterial Mix(int index, ParameterReader& reader);
  int MixElement(const std::string& name, int index, ParameterReader& reader);

  RoughnessInput Roughness(ParameterReader& reader);
  EtaInput Eta(ParameterReader& reader);
  void ReadRelief(ParameterReader& reader, Material& material);

  const SceneDescription& scene_;
  TextureBuilder& textures_;
  CoatTableCache coats_;
};

}  // namespace tessera
