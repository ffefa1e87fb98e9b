#include "renderer/scene/probe_scene.h"

#include <cstdint>

namespace tessera {

std::span<const ProbeVariant> ProbeVariants() {
  static constexpr ProbeVariant kVariants[] = {
      {R"(Sampler "independent" "integer pixelsamples" 3 PixelFilter "box"
          Integrator "path" "string lightsampler" "power")",
       "embree", true, true},
      {R"(Sampler "stratified" "integer xsamples" 2 "integer ysamples" 2 PixelFilter "gaussian"
          Integrator "volpath" "string lightsampler" "bvh")",
       "bvh", true, true},
      {R"(Sampler "sobol" "integer pixelsamples" 4 "string randomization" "permutedigits" PixelFilter "mitchell"
          Film "gbuffer" "integer xresolution" 24 "integer yresolution" 16 "float iso" 120
          Integrator "volpath" "integer maxdepth" 12 "string lightsampler" "uniform")",
       "embree", true, false},
      {R"(Sampler "paddedsobol" "integer pixelsamples" 4 "string randomization" "owen" PixelFilter "sinc"
          Integrator "simplevolpath")",
       "list", true, true},
      {R"(Sampler "zsobol" "integer pixelsamples" 4 PixelFilter "triangle" Integrator "simplepath"
          Camera "orthographic" "float screenwindow" [ -4 4 -2.2 3.2 ])",
       "embree", true, false},
      {R"(Sampler "halton" "integer pixelsamples" 4 PixelFilter "gaussian" Integrator "randomwalk"
          Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "string sensor" "nikon_d850"
          Camera "spherical")",
       "embree", true, false},
      {R"(Sampler "pmj02bn" "integer pixelsamples" 4 PixelFilter "gaussian" Integrator "mixture"
          Camera "realistic" "string lensfile" "probe.lens" "float aperturediameter" 15 "float focusdistance" 9
          "string aperture" "gaussian")",
       "embree", false, false},
  };
  return kVariants;
}

const char* const kProbeHead = R"(
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "float iso" 120 "float maxcomponentvalue" 50
LookAt 0 2.2 -9   0 1.4 0   0 1 0
ActiveTransform EndTime Translate 0.1 0 0 ActiveTransform All
Camera "perspective" "float fov" 44 "float lensradius" 0.05 "float focaldistance" 9
MakeNamedMedium "haze" "string type" "homogeneous" "rgb sigma_a" [ 0.01 0.02 0.03 ] "rgb sigma_s" [ 0.02 0.02 0.01 ]
  "float g" 0.4
MediumInterface "" "haze"
)";

// Four rows of five balls in front of a wall; the top row holds shapes and lights.
const char* const kProbeWorld = R"(
WorldBegin
MakeNamedMedium "milk" "string type" "homogeneous" "string preset" "Wholemilk" "float scale" 0.5
MakeNamedMedium "ember" "string type" "homogeneous" "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 1 2 3 ]
  "rgb Le" [ 0.8 0.3 0.1 ] "float g" -0.5
AttributeBegin Translate -1.2 -0.2 -3.6 Rotate 30 1 2 3
  MakeNamedMedium "smoke" "string type" "uniformgrid" "integer nx" 3 "integer ny" 2 "integer nz" 2 "rgb sigma_s" [ 9 4 2 ]
    "float density" [ 0 1 4 2 0 0 3 1 0 1 5 0 ] "float temperature" [ 0 900 3000 0 0 0 2000 0 0 0 4000 0 ]
    "point3 p0" [ -0.3 -0.3 -0.3 ] "point3 p1" [ 0.3 0.3 0.3 ] AttributeEnd
AttributeBegin Translate 0 -0.2 -3.8
  MakeNamedMedium "paint" "string type" "rgbgrid" "integer nx" 2 "rgb sigma_a" [ 1 3 9 9 3 1 ] "rgb sigma_s" [ 9 1 0 0 1 9 ]
    "rgb Le" [ 0.1 0 0 0 0.1 0.2 ] "point3 p0" [ -0.25 -0.25 -0.25 ] "point3 p1" [ 0.25 0.25 0.25 ] AttributeEnd
AttributeBegin Translate 0.8 -0.6 -4 Scale 0.8 0.8 0.8
  MakeNamedMedium "cumulus" "string type" "cloud" "rgb sigma_a" [ 0.1 0.2 0.3 ] "rgb sigma_s" [ 20 20 20 ] AttributeEnd
AttributeBegin
  Rotate 30 0 1 0
  LightSource "infinite" "string filename" "probe.pfm" "float scale" 0.3
AttributeEnd
LightSource "infinite" "blackbody L" [ 6500 ] "float scale" 0.1
AttributeBegin
  Rotate 70 1 0 1
  LightSource "infinite" "string filename" "probe.pfm" "float illuminance" 2
    "point3 portal" [ -6 -1 -3  -6 5 -3  -6 5 3  -6 -1 3 ]
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "blackbody L" [ 3200 ] "float scale" 4
  Translate -3 3.6 0 Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 2 4 6 ] "bool twosided" true
  Translate -1.5 3.6 0 Shape "disk" "float radius" 0.4 "float innerradius" 0.1
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "spectrum L" [ 400 1 550 3 700 2 ]
  Translate 0 3.3 0 Rotate -90 1 0 0 Shape "cylinder" "float radius" 0.3 "float zmin" 0 "float zmax" 0.6 "float phimax" 270
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 3 3 1 ] "float power" 20
  Translate 1.5 3.6 0 Shape "bilinearmesh" "point3 P" [ -0.4 -0.4 0  0.4 -0.3 0.2  -0.4 0.4 0  0.4 0.4 -0.2 ]
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "string filename" "probe.pfm" "float scale" 5
  Translate 3 3.6 0 Shape "trianglemesh" "point3 P" [ -0.4 -0.4 0  0.4 -0.4 0  0 0.4 0 ] "point2 uv" [ 0 0 1 0 0 1 ]
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 1 2 2 ] "bool twosided" true
  Translate 0 4.2 -1 Rotate 20 1 1 0 Shape "trianglemesh" "integer indices" [ 0 1 2  0 2 3 ]
    "point3 P" [ -0.6 -0.3 0  0.6 -0.3 0  0.6 0.3 0  -0.6 0.3 0 ]
AttributeEnd

Texture "image" "spectrum" "imagemap" "string filename" "probe.pfm" "string filter" "ewa"
Texture "image3" "spectrum" "imagemap" "string filename" "probe.pfm" "string filter" "trilinear" "float uscale" 3
  "string wrap" "clamp" "bool invert" true
Texture "image1" "float" "imagemap" "string filename" "probe.pfm" "string filter" "bilinear" "string wrap" "black"
Texture "image0" "float" "imagemap" "string filename" "probe.pfm" "string filter" "point" "float vscale" 2
Texture "checker" "spectrum" "checkerboard" "float uscale" 4 "float vscale" 4 "texture tex1" "image" "rgb tex2" [ 0.1 0.2 0.4 ]
Texture "blocks" "spectrum" "checkerboard" "integer dimension" 3 "rgb tex1" [ 0.9 0.7 0.2 ] "rgb tex2" [ 0.2 0.1 0.4 ]
Texture "bilerp" "spectrum" "bilerp" "rgb v00" [ 0.9 0.1 0.1 ] "rgb v01" [ 0.1 0.9 0.1 ] "rgb v10" [ 0.1 0.1 0.9 ]
  "rgb v11" [ 0.8 0.8 0.8 ] "string mapping" "spherical"
Texture "dots" "spectrum" "dots" "rgb inside" [ 0.9 0.9 0.1 ] "rgb outside" [ 0.1 0.1 0.3 ] "string mapping" "cylindrical"
Texture "marble" "spectrum" "marble" "float variation" 0.6 "float scale" 3
Texture "facing" "spectrum" "directionmix" "texture tex1" "marble" "texture tex2" "bilerp" "vector3 dir" [ 0.3 0.8 -0.5 ]
Texture "grain" "float" "fbm" "integer octaves" 5 "float roughness" 0.6
Texture "folds" "float" "wrinkled" "integer octaves" 4
Texture "gusts" "float" "windy"
Texture "planar" "float" "checkerboard" "float tex1" 1 "float tex2" 0
  "string mapping" "planar" "vector3 v1" [ 5 0 0 ] "vector3 v2" [ 0 5 0 ]
Texture "small" "float" "scale" "texture tex" "gusts" "float scale" 0.2
Texture "mixed" "spectrum" "mix" "texture tex1" "dots" "texture tex2" "checker" "texture amount" "grain"
Texture "flat" "spectrum" "constant" "rgb value" [ 0.4 0.5 0.3 ]

Material "diffuse" "texture reflectance" "image3"
Shape "bilinearmesh" "point3 P" [ -5 -1 2  5 -1 2  -5 5 2  5 5 2 ]
Material "coateddiffuse" "texture reflectance" "checker" "float roughness" 0.1
Shape "trianglemesh" "point3 P" [ -6 -0.5 -4  6 -0.5 -4  6 -0.5 3  -6 -0.5 3 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
  "normal N" [ 0 1 0  0.1 1 0  0 1 0.1  0 1 0 ] "integer indices" [ 0 2 1 0 3 2 ]

AttributeBegin Translate -3 0.2 0 Material "diffuse" "texture reflectance" "mixed" Shape "sphere" "float radius" 0.6 AttributeEnd
AttributeBegin Translate -1.5 0.2 0 Material "diffusetransmission" "texture reflectance" "blocks" "rgb transmittance" [ 0.3 0.4 0.2 ]
  Shape "sphere" "float radius" 0.6 AttributeEnd
AttributeBegin Translate 0 0.2 0 Material "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float roughness" 0.02
  Shape "sphere" "float radius" 0.6 AttributeEnd
AttributeBegin Translate 1.5 0.2 0 Material "conductor" "rgb reflectance" [ 0.7 0.8 0.9 ] "float uroughness" 0.4 "float vroughness" 0.1
  Shape "sphere" "float radius" 0.6 "float phimax" 300 AttributeEnd
AttributeBegin Translate 3 0.2 0 Material "conductor" "float roughness" 0 "texture displacement" "small" Shape "sphere" "float radius" 0.6 AttributeEnd

AttributeBegin Translate -3 1.5 0 Material "dielectric" "float eta" 1.5 Shape "sphere" "float radius" 0.6 AttributeEnd
AttributeBegin Translate -1.5 1.5 0 Material "dielectric" "spectrum eta" "glass-F11" "float roughness" 0.3 MediumInterface "milk" "haze"
  Shape "sphere" "float radius" 0.6 AttributeEnd
AttributeBegin Translate 0 1.5 0 Material "thindielectric" "float eta" 1.4 Shape "sphere" "float radius" 0.6 AttributeEnd
AttributeBegin Translate 1.5 1.5 0 Material "interface" MediumInterface "ember" "haze" Shape "sphere" "float radius" 0.6 AttributeEnd
AttributeBegin Translate -1.2 -0.2 -3.6 Material "interface" MediumInterface "smoke" "haze" Shape "sphere" "float radius" 0.3 AttributeEnd
AttributeBegin Translate 0 -0.2 -3.8 Material "dielectric" MediumInterface "paint" "haze" Shape "sphere" "float radius" 0.25 AttributeEnd
AttributeBegin Translate 1.2 -0.2 -3.6 Material "interface" MediumInterface "cumulus" "haze" Shape "sphere" "float radius" 0.35 AttributeEnd
AttributeBegin Translate 3 1.5 0 Material "coateddiffuse" "texture reflectance" "facing" "float roughness" 0 "float thickness" 0.05
  "rgb albedo" [ 0.4 0.3 0.2 ] Shape "sphere" "float radius" 0.6 AttributeEnd

AttributeBegin Translate -1.7 -0.2 -2.2 Material "coatedconductor" "float conductor.roughness" 0.05 "float interface.roughness" 0.02
  "float thickness" 0.1 "rgb albedo" [ 0.2 0.3 0.6 ] "float g" 0.3 Shape "sphere" "float radius" 0.3 AttributeEnd
AttributeBegin Translate -0.8 -0.2 -2.5 Material "coatedconductor" "rgb reflectance" [ 0.9 0.6 0.3 ] "spectrum interface.eta" "glass-BK7"
  "float conductor.uroughness" 0.1 Shape "sphere" "float radius" 0.25 AttributeEnd
AttributeBegin Translate 0.9 -0.2 -2.5 Material "hair" "texture eumelanin" "grain" Shape "sphere" "float radius" 0.25 AttributeEnd
AttributeBegin Translate 1.8 -0.2 -2.2 Material "hair" "rgb reflectance" [ 0.8 0.4 0.2 ] "float beta_m" 0.6 "float alpha" 4
  Shape "sphere" "float radius" 0.3 AttributeEnd

MakeNamedMaterial "leaf" "string type" "diffuse" "texture reflectance" "flat" "string normalmap" "probe.pfm"
MakeNamedMaterial "foil" "string type" "conductor" "spectrum eta" "metal-Al-eta" "spectrum k" "metal-Al-k" "texture roughness" "image1"
MakeNamedMaterial "both" "string type" "mix" "string materials" [ "leaf" "foil" ] "texture amount" "folds"
ObjectBegin "thing"
  NamedMaterial "both"
  Shape "plymesh" "string filename" "probe.ply"
  Shape "disk" "float radius" 0.3 "float height" 0.5 "texture alpha" "planar"
ObjectEnd
AttributeBegin Translate -2.2 2.6 -0.5 ObjectInstance "thing" AttributeEnd
AttributeBegin Translate 0 2.6 -0.5 Rotate 40 0 1 0 Scale 1.2 0.8 1 ObjectInstance "thing" AttributeEnd
AttributeBegin Translate 2.2 2.6 -0.5 Rotate 70 1 1 0 Scale -1 1 1 ReverseOrientation ObjectInstance "thing" AttributeEnd
AttributeBegin Translate 0 -0.2 -2 Material "diffuse" "texture reflectance" "image" Shape "cylinder" "float radius" 0.25 "texture alpha" "image0" AttributeEnd

AttributeBegin Translate -2.8 0 -2.4 Material "hair" "float eumelanin" 0.6
  Shape "curve" "string type" "cylinder" "string basis" "bspline" "float width0" 0.3 "float width1" 0.1
    "point3 P" [ 0 -1 0  0.3 -0.4 0.2  -0.3 0.1 0  0.2 0.5 -0.2  0 1.2 0  0.1 1.6 0 ]
  Scale 1 0.7 1.3 Shape "curve" "integer degree" 2 "float width" 0.2 "point3 P" [ -0.7 -0.6 0  -0.2 0.8 0.1  -0.6 1.4 0 ]
AttributeEnd
AttributeBegin Translate 2.4 -0.2 -3.6 Material "subsurface" "texture reflectance" "flat" "rgb mfp" [ 0.2 0.1 0.05 ]
  "float roughness" 0.1 "float g" 0.3 Shape "sphere" "float radius" 0.3 AttributeEnd
AttributeBegin Translate -2.4 -0.2 -3.6 Material "subsurface" "string name" "Skin1" "float scale" 9
  Shape "sphere" "float radius" 0.3 AttributeEnd
AttributeBegin Translate 2.8 0 -2.4 Material "diffuse" "texture reflectance" "checker"
  Shape "curve" "string type" "ribbon" "string basis" "bspline" "integer degree" 2 "float width" 0.4
    "normal N" [ 0.4 0 -1  -0.5 0.3 -1  0 0 1 ] "point3 P" [ 0 -1 0  0.3 -0.2 0  -0.2 0.5 0.3  0 1.5 0 ]
  Translate -0.7 0 0 Shape "loopsubdiv" "integer levels" 2 "point3 P" [ 0 0.4 0  0.3 -0.2 0.2  -0.3 -0.2 0.2  0 -0.2 -0.3 ]
    "integer indices" [ 0 1 2  0 3 1  0 2 3  1 3 2 ]
AttributeEnd

AttributeBegin Translate -1 0.6 -3 ActiveTransform EndTime Rotate 70 1 2 0 Scale 1.4 0.8 1 ActiveTransform All
  Scale 0.5 0.5 0.5 ObjectInstance "thing"
  MediumInterface "milk" "haze" Translate 1 0 0 ActiveTransform StartTime Rotate 30 0 1 0 ActiveTransform All
  AreaLightSource "diffuse" "rgb L" [ 1 3 2 ] Shape "sphere" "float radius" 0.4
AttributeEnd
)";

const char* const kProbeLightsOfNoSize = R"(
LightSource "point" "rgb I" [ 2 3 4 ] "point3 from" [ -4 4 -5 ]
LightSource "spot" "blackbody I" [ 4000 ] "float scale" 6 "point3 from" [ 4 5 -5 ] "point3 to" [ 1 0 0 ] "float coneangle" 30
LightSource "distant" "rgb L" [ 0.2 0.2 0.1 ] "point3 from" [ 1 3 -2 ] "point3 to" [ 0 0 0 ]
AttributeBegin
  ActiveTransform EndTime Rotate 20 0 1 0 ActiveTransform All
  LightSource "spot" "rgb I" [ 20 30 20 ] "point3 from" [ 0 5 -5 ] "point3 to" [ 0 0 0 ] "float coneangle" 20
  LightSource "infinite" "string filename" "probe.pfm" "float scale" 0.05
AttributeEnd
AttributeBegin
  Translate 0 4.5 -3
  LightSource "goniometric" "string filename" "probe.pfm" "rgb I" [ 4 4 5 ]
  LightSource "goniometric" "string filename" "probe.ies" "blackbody I" [ 4500 ] "float power" 60
  Rotate 50 1 0 0
  LightSource "projection" "string filename" "probe.pfm" "float fov" 60 "float power" 30
AttributeEnd
)";

const char* const kProbeVisibility = R"(
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 3 2 1 ] "string group" "key" "string link_exclude" "wall*" "bool cast_shadows" false
  Translate -1.5 3.4 -2
  Shape "sphere" "float radius" 0.3 "bool visible_camera" false
AttributeEnd
LightSource "spot" "point3 from" [ 1 4 -4 ] "point3 to" [ 0 0 -2 ] "rgb I" [ 30 30 30 ] "string link_include" "card"
Material "diffuse" "rgb reflectance" [ 0.4 0.5 0.6 ]
Shape "bilinearmesh" "string name" "card" "bool visible_shadow" false "point3 P" [ -3 3 -3  -1 3 -3  -3 3 -1  -1 3 -1 ]
Shape "trianglemesh" "string name" "wall" "bool visible_indirect" false
  "point3 P" [ 1 3 -3  3 3 -3  1 3 -1 ] "integer indices" [ 0 1 2 ]
)";

const char* const kProbeMesh =
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 3\nproperty list uchar int vertex_indices\nend_header\n"
    "-0.4 -0.3 0\n0.4 -0.3 0.1\n0.4 0.3 -0.1\n-0.4 0.3 0\n0 0.1 -0.5\n"
    "4 0 1 2 3\n3 0 1 4\n3 2 3 4\n";

const char* const kProbeLuminaire =
    "IESNA:LM-63-2002\nTILT=NONE\n1 800 1 4 3 1 2 0 0 0\n1 1 60\n0 30 60 120\n0 45 90\n"
    "900 700 200 0\n900 800 300 0\n900 850 350 0\n";

// Two elements and a stop.
const char* const kProbeLens = "30 6 1.6 26\n-60 2 1 26\n0 4 0 20\n-25 2 1.7 20\n-40 30 1 20\n";

std::string ProbeImage() {
  constexpr int kSide = 8;
  std::string file = "PF\n8 8\n1.0\n";  // big-endian
  uint32_t state = 1;
  for (int i = 0; i < kSide * kSide * 3; ++i) {
    state = state * 1664525 + 1013904223;                         // any pattern without symmetry
    const uint32_t bits = 0x3f000000u | (state >> 9 & 0x7ffffe);  // a float in [0.5, 1)
    for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(bits >> shift & 0xff);
  }
  return file;
}

}  // namespace tessera
