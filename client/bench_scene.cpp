#include "client/bench_scene.h"

#include <fmt/format.h>

namespace tessera {
namespace {

constexpr int kRows = 25, kColumns = 40;

constexpr const char* kBenchHead = R"(
Film "rgb" "integer xresolution" 320 "integer yresolution" 180
Sampler "zsobol" "integer pixelsamples" 16
PixelFilter "gaussian"
Integrator "path" "integer maxdepth" 8
LookAt 0 9 -22   0 0 4   0 1 0
Camera "perspective" "float fov" 46 "float lensradius" 0.05 "float focaldistance" 24
WorldBegin
LightSource "infinite" "rgb L" [ 0.35 0.45 0.6 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 22 18 12 ]
  Translate -10 16 -6
  Shape "sphere" "float radius" 2
AttributeEnd
Texture "tiles" "spectrum" "checkerboard" "float uscale" 40 "float vscale" 40 "rgb tex1" [ 0.7 0.7 0.65 ]
  "rgb tex2" [ 0.2 0.25 0.3 ]
Material "diffuse" "texture reflectance" "tiles"
Shape "trianglemesh" "point3 P" [ -60 -0.5 -30  60 -0.5 -30  60 -0.5 60  -60 -0.5 60 ] "integer indices" [ 0 2 1 0 3 2 ]
  "point2 uv" [ 0 0  1 0  1 1  0 1 ]
)";

constexpr const char* kMaterials[] = {
    R"("diffuse" "rgb reflectance" [ 0.7 0.2 0.15 ])",
    R"("coateddiffuse" "rgb reflectance" [ 0.1 0.35 0.6 ] "float roughness" 0.05)",
    R"("conductor" "spectrum eta" "metal-Cu-eta" "spectrum k" "metal-Cu-k" "float roughness" 0.1)",
    R"("dielectric" "float eta" 1.5)",
    R"("diffusetransmission" "rgb reflectance" [ 0.3 0.5 0.2 ] "rgb transmittance" [ 0.2 0.3 0.1 ])",
};

}  // namespace

std::string BenchScene() {
  std::string scene = kBenchHead;
  for (int i = 0; i < kRows * kColumns; ++i) {
    const int row = i / kColumns, column = i % kColumns;
    scene += fmt::format(
        "AttributeBegin Material {} Translate {} {} {} Shape \"sphere\" \"float radius\" 0.45 AttributeEnd\n",
        kMaterials[static_cast<size_t>((3 * row + column) % 5)], column - kColumns / 2,
        (row * column) % 3 * 0.5, row - 5);
  }
  return scene;
}

}  // namespace tessera
