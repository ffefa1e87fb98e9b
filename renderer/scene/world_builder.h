// From a scene's description to the World that paths meet.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/description/scene_description.h"
#include "renderer/image/image.h"
#include "renderer/integrator/world.h"
#include "renderer/scene/matte_names.h"

namespace tessera {

struct WorldRequest {
  const SceneDescription& scene;
  FileSource& files;
  ImageCache& images;
  LightSamplerKind light_sampler = LightSamplerKind::kTree;
  bool with_media = false;      // the integrator follows media
  SceneNames* names = nullptr;  // of mattes; null if nothing is named
  bool average_images = false;  // of textures
};

// Fills geometry, textures, materials, media and lights of `world`, whose camera is ready. The accelerator
// stays null. Returns the shapes that emit.
Result<std::vector<EmittingShape>> BuildWorld(const WorldRequest& request, World* world,
                                              Diagnostics& diagnostics);

}  // namespace tessera
