// Small scenes with layers, and the values that tiles of them hold.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

inline constexpr uint32_t kLayerSamples = 256;

// Looks along +z from (1, 2, 3) at a grey ball that covers the view, 4 units away.
inline constexpr const char* kBall = R"(
LookAt 1 2 3  1 2 4  0 1 0
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 10
Sampler "independent"
WorldBegin
LightSource "infinite"
Material "diffuse" "rgb reflectance" [ 0.6 0.4 0.2 ]
Translate 1 2 17
Shape "sphere" "float radius" 10
)";

inline std::unique_ptr<Scene> LoadWith(const std::string& text, const std::set<std::string>& layers) {
  MemoryFiles files({{"scene.pbrt", text}});
  RenderOptions options;
  options.aovs = layers;
  options.samples_per_pixel = kLayerSamples;
  Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : nullptr;
}

inline RadianceTile Rendered(const Scene& scene) {
  return *scene.Render({0, 0, 4, 4}, {}, {0, kLayerSamples}, nullptr);
}

// A channel of pixel (2, 1) as the tile holds it, next to the middle of the picture.
inline float Held(const Scene& scene, const RadianceTile& tile, const std::string& channel) {
  const ChannelLayout layout = scene.frame().Layout();
  return tile.sums[(1 * 4 + 2) * layout.shape().stride() + *layout.SlotOf(channel)];
}
inline float Mean(const Scene& scene, const RadianceTile& tile, const std::string& channel) {
  return Held(scene, tile, channel) / Held(scene, tile, "W");
}

// Glass, a coat over a diffuse base, glossy metal, fog, lights of all kinds and a clamp.
inline constexpr const char* kStage = R"(
Integrator "INTEGRATOR" "integer maxdepth" 6
LookAt 0 1 -5  0 0.5 0  0 1 0
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false "float maxcomponentvalue" 2
PixelFilter "box"
Camera "perspective" "float fov" 40
Sampler "independent"
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.3 0.4 ]
LightSource "point" "point3 from" [ 2 4 -3 ] "rgb I" [ 20 18 15 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 5 4 3 ]
  Translate -1 1.6 0
  Shape "sphere" "float radius" 0.4
AttributeEnd
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.4 0.2 ] "float roughness" 0.3
Shape "bilinearmesh" "point3 P" [ -9 0 -9  9 0 -9  -9 0 9  9 0 9 ]
Material "dielectric"
AttributeBegin
Translate 0.7 0.6 -1
Shape "sphere" "float radius" 0.5
AttributeEnd
Material "diffusetransmission"
AttributeBegin
Translate -0.7 0.4 -1
Shape "sphere" "float radius" 0.4
AttributeEnd
Material "conductor" "float roughness" 0.2
AttributeBegin
Translate 0.1 1.5 0
Shape "sphere" "float radius" 0.4
AttributeEnd
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [ 1 1 1 ] "rgb Le" [ 0.1 0.1 0.1 ]
MediumInterface "fog" ""
Material "interface"
Translate 0 0.5 -2
Shape "sphere" "float radius" 0.4
)";

inline std::string StageFor(const std::string& integrator) {
  std::string text = kStage;
  text.replace(text.find("INTEGRATOR"), 10, integrator);
  // Some trace no shadow rays, which alone find a point.
  const size_t point = text.find("LightSource \"point\"");
  if (integrator == "mixture" || integrator == "simplevolpath" || integrator == "randomwalk")
    text.erase(point, text.find('\n', point) - point);
  return text;
}

}  // namespace tessera
