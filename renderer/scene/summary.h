// What a scene holds, in numbers.
#pragma once

#include "renderer/description/scene_description.h"
#include "renderer/image/image.h"
#include "renderer/integrator/world.h"
#include "renderer/scene/scene.h"

namespace tessera {

// Fills the counts and bytes of `summary`.
void Summarize(const SceneDescription& scene, const World& world, const ImageCache& images,
               SceneSummary* summary);

}  // namespace tessera
