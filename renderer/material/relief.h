// Bump and normal mapping: changes the shading frame of a point as if the surface had relief (J. Blinn,
// "Simulation of Wrinkled Surfaces", 1978).
#pragma once

#include <memory>
#include <optional>

#include "renderer/material/material_reader.h"
#include "renderer/material/normal_map.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// The relief of one material; flat by default.
class Relief {
 public:
  // The parameters `displacement`, a float texture, and `normalmap`, the name of an image file.
  static Relief Read(MaterialReader& reader);

  bool ReadsTextures() const { return displacement_ || normal_map_; }
  // Whether Apply uses the derivatives of the normal.
  bool NeedsNormalDerivatives() const { return displacement_ && !normal_map_; }
  // A normal map takes precedence over a displacement. Leaves the shading frame as it is if there is neither,
  // or where the relief gives no normal.
  void Apply(const TextureTable& textures, const TextureContext& context,
             SurfaceInteraction& interaction) const {
    if (normal_map_) {
      ApplyNormalMap(interaction);
    } else if (displacement_) {
      ApplyBumpMap(textures, context, interaction);
    }
  }

 private:
  // Displaces the surface along its normal; finite differences over about a pixel, as in pbrt-v4.
  void ApplyBumpMap(const TextureTable& textures, const TextureContext& context,
                    SurfaceInteraction& interaction) const;
  void ApplyNormalMap(SurfaceInteraction& interaction) const;

  std::optional<FloatInput> displacement_;
  std::shared_ptr<const NormalMap> normal_map_;
};

}  // namespace tessera
