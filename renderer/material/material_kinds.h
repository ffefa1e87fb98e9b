// The kinds of material, and what scenes call them.
#pragma once

#include <variant>

#include "renderer/description/kind_table.h"
#include "renderer/material/coated_conductor_material.h"
#include "renderer/material/coated_diffuse_material.h"
#include "renderer/material/conductor_material.h"
#include "renderer/material/dielectric_material.h"
#include "renderer/material/diffuse_material.h"
#include "renderer/material/diffuse_transmission_material.h"
#include "renderer/material/hair_material.h"
#include "renderer/material/interface_material.h"
#include "renderer/material/measured_material.h"
#include "renderer/material/mix_material.h"
#include "renderer/material/relief.h"
#include "renderer/material/subsurface_material.h"
#include "renderer/material/thin_dielectric_material.h"

namespace tessera {

// Every kind has
//   static Kind Read(MaterialReader& reader);            unless it has no parameters
//   bool ReadsTextures() const;                          whether any of its inputs is a texture
//   bool IsIsotropic() const;                            whether its BxDFs are the same for all tangents
//   Bxdf MakeBxdf(const MaterialContext& at) const;
using SurfaceMaterialKind =
    std::variant<DiffuseMaterial, DiffuseTransmissionMaterial, ConductorMaterial, DielectricMaterial,
                 ThinDielectricMaterial, CoatedDiffuseMaterial, CoatedConductorMaterial, HairMaterial,
                 MeasuredMaterial, SubsurfaceMaterial, InterfaceMaterial>;

// A material that scatters light.
struct SurfaceMaterial {
  SurfaceMaterialKind kind;
  Relief relief;
};

using Material = std::variant<SurfaceMaterial, MixMaterial>;

// What scenes call the kinds, and what reads each from its directive.
KindTable<Material (*)(MaterialReader&)> MaterialKinds();

}  // namespace tessera
