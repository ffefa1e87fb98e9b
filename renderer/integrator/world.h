// Everything that a path interacts with.
#pragma once

#include <memory>

#include "renderer/accelerator/accelerator.h"
#include "renderer/camera/camera.h"
#include "renderer/light/light.h"
#include "renderer/light/light_links.h"
#include "renderer/material/material.h"
#include "renderer/medium/medium.h"
#include "renderer/shape/geometry.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Immutable once built, shared by all threads. The accelerator refers to `geometry` and `textures`, the
// lights to `geometry`: a World does not move.
struct World {
  Camera camera;
  Geometry geometry;
  TextureTable textures;
  MaterialTable materials;
  LightTable lights;
  LightLinks links;
  MediumTable media;            // empty if no ray can be in one, or the integrator does not follow them
  int camera_medium = -1;       // index into media; -1: vacuum
  bool has_interfaces = false;  // whether any surface is `interface`
  bool has_subsurface = false;  // whether light is scattered below any surface; `volpath` alone follows it
  // Whether any surface but interfaces lets shadow rays pass.
  bool passes_shadow_rays = false;
  bool moves = false;                        // whether the picture depends on the times of rays
  std::unique_ptr<Accelerator> accelerator;  // null if the scene is only checked
};

}  // namespace tessera
