#include "renderer/material/material_kinds.h"

namespace tessera {
namespace {

template <typename SurfaceKind>
Material ReadSurface(MaterialReader& reader) {
  SurfaceMaterialKind kind = SurfaceKind::Read(reader);
  return SurfaceMaterial{std::move(kind), Relief::Read(reader)};
}

// The parameters of an interface have no meaning.
Material ReadInterface(MaterialReader& reader) {
  reader.parameters.IgnoreRest();
  return SurfaceMaterial{InterfaceMaterial{}, {}};
}

// Hair has no relief.
Material ReadHair(MaterialReader& reader) {
  return SurfaceMaterial{HairMaterial::Read(reader), {}};
}

Material ReadMix(MaterialReader& reader) {
  return MixMaterial::Read(reader);
}

constexpr Kind<Material (*)(MaterialReader&)> kKinds[] = {
    {"diffuse", Support::kSupported, ReadSurface<DiffuseMaterial>},
    {"diffusetransmission", Support::kSupported, ReadSurface<DiffuseTransmissionMaterial>},
    {"conductor", Support::kSupported, ReadSurface<ConductorMaterial>},
    {"dielectric", Support::kSupported, ReadSurface<DielectricMaterial>},
    {"thindielectric", Support::kSupported, ReadSurface<ThinDielectricMaterial>},
    {"coateddiffuse", Support::kSupported, ReadSurface<CoatedDiffuseMaterial>},
    {"coatedconductor", Support::kSupported, ReadSurface<CoatedConductorMaterial>},
    {"hair", Support::kSupported, ReadHair},
    {"measured", Support::kSupported, ReadSurface<MeasuredMaterial>},
    {"subsurface", Support::kSupported, ReadSurface<SubsurfaceMaterial>},
    {"mix", Support::kSupported, ReadMix},
    {"interface", Support::kSupported, ReadInterface},
    {"none", Support::kSupported, ReadInterface},
};

}  // namespace

KindTable<Material (*)(MaterialReader&)> MaterialKinds() {
  return {"material", kKinds};
}

}  // namespace tessera
