// What a scene holds, in numbers.
#pragma once

#include "image/image.h"
#include "integrator/world.h"
#include "language/scene_description.h"
#include "scene/scene.h"

namespace tessera {

// Fills the counts and bytes of `summary`.
void Summarize(const SceneDescription& scene, const World& world, const ImageCache& images,
               SceneSummary* summary);

}  // namespace tessera
