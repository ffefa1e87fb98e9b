// Small scenes on which estimators must agree. Each has something that one of them could get wrong.
#pragma once

#include <cstring>
#include <string>
#include <vector>

namespace tessera {

// A square environment map of 4 x 4 texels as a portable float map: one texel far brighter than the others.
inline std::string BrightTexelMap() {
  std::vector<float> values(4 * 4 * 3, 0.2f);
  const float bright[3] = {9, 7, 4};
  std::memcpy(&values[(1 * 4 + 2) * 3], bright, sizeof bright);
  std::string file = "PF\n4 4\n-1.0\n";
  file.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return file;
}

// The start of all scenes: 8 x 8 pixels, looking along +z.
inline std::string SceneHead(const std::string& integrator, int max_depth) {
  return R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 70
Sampler "independent" "integer pixelsamples" 4096
Integrator )" +
         integrator + " \"integer maxdepth\" " + std::to_string(max_depth) + "\nWorldBegin\n";
}

// A box of diffuse walls around the camera, open at the back, with a lamp of two triangles.
constexpr const char* kDiffuseBox = R"(
Material "diffuse" "rgb reflectance" [ 0.7 0.7 0.7 ]
Shape "bilinearmesh" "point3 P" [ -2 -2 -1  2 -2 -1  -2 -2 5  2 -2 5 ]
Shape "bilinearmesh" "point3 P" [ -2 -2 5  2 -2 5  -2 2 5  2 2 5 ]
Material "diffuse" "rgb reflectance" [ 0.7 0.2 0.1 ]
Shape "trianglemesh" "point3 P" [ -2 -2 -1  -2 -2 5  -2 2 5  -2 2 -1 ] "integer indices" [ 0 1 2 0 2 3 ]
AreaLightSource "diffuse" "rgb L" [ 6 5 4 ] "bool twosided" true
Shape "trianglemesh" "point3 P" [ -1 1.8 2  1 1.8 2  1 1.8 4  -1 1.8 4 ] "integer indices" [ 0 1 2 0 2 3 ]
)";

// Lights behind lights: a sphere in a cylinder (hit twice) under a disk, and a curved patch; an `interface`
// in front of them, and a lamp whose dark back covers a part of the others.
constexpr const char* kHiddenLights = R"(
Material "diffuse" "rgb reflectance" [ 0.5 0.6 0.7 ]
Shape "bilinearmesh" "point3 P" [ -4 -1 0  4 -1 0  -4 -1 8  4 -1 8 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 1 2 3 ]
  Translate 0.5 1.2 4
  Shape "sphere" "float radius" 0.3
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 0.8 0.4 0.2 ] "bool twosided" true
  Translate 0.5 1.2 4
  Shape "cylinder" "float radius" 0.8 "float zmin" -0.3 "float zmax" 0.6
  Rotate 80 1 0 0
  Translate 0 0 -1
  Shape "disk" "float radius" 0.9 "float innerradius" 0.2
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 2 1 1 ]
  Shape "bilinearmesh" "point3 P" [ -2 2 3  -1 1 3  -2 1 5  -1 2 5 ]
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 3 3 3 ]
  Translate 0 1 3
  Rotate -90 1 0 0
  Shape "disk" "float radius" 0.4
AttributeEnd
AttributeBegin
  Material "interface"
  Translate 0 0 4
  Shape "sphere" "float radius" 0.7
AttributeEnd
)";

// Glass, rough metal and a glazed floor under a small emitting sphere.
constexpr const char* kGlossyThings = R"(
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.5 0.3 ] "float roughness" 0
Shape "bilinearmesh" "point3 P" [ -4 -1 0  4 -1 0  -4 -1 8  4 -1 8 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 8 8 8 ]
  Translate 0 1.8 3.5
  Shape "sphere" "float radius" 0.6
AttributeEnd
AttributeBegin
  Material "conductor" "float roughness" 0.3
  Translate -1 -0.2 4.5
  Shape "sphere" "float radius" 0.8
AttributeEnd
AttributeBegin
  Material "dielectric" "float eta" 1.5
  Translate 0.8 -0.2 4
  Shape "sphere" "float radius" 0.8
AttributeEnd
)";

// A nearly black floor, which a mirror of 0.3 shows to a lamp behind the camera.
constexpr const char* kMirrorOverADarkFloor = R"(
Material "diffuse" "rgb reflectance" [ 0.02 0.02 0.02 ]
Shape "bilinearmesh" "point3 P" [ -8 -1 -1  8 -1 -1  -8 -1 6  8 -1 6 ]
Material "conductor" "rgb reflectance" [ 0.3 0.3 0.3 ] "float roughness" 0
Shape "bilinearmesh" "point3 P" [ -8 0 6  8 0 6  -8 8 6  8 8 6 ]
AreaLightSource "diffuse" "rgb L" [ 100 100 100 ] "bool twosided" true
Shape "bilinearmesh" "point3 P" [ -8 2 -2  8 2 -2  -8 10 -2  8 10 -2 ]
)";

// A sky that is sampled in part, a constant one that never is, and a lamp in front of them.
constexpr const char* kSkies = R"(
LightSource "infinite" "string filename" "sky.pfm"
LightSource "infinite" "rgb L" [ 0.1 0.1 0.2 ]
Material "diffuse" "rgb reflectance" [ 0.7 0.7 0.7 ]
Shape "bilinearmesh" "point3 P" [ -4 -1 0  4 -1 0  -4 -1 8  4 -1 8 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 2 2 2 ]
  Translate -1 1 4
  Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
  Material "conductor" "float roughness" 0.4
  Translate 1 0 4.5
  Shape "sphere" "float radius" 0.9
AttributeEnd
)";

// A room around the camera and things in it. The wall on the right has a window from (2, -0.5, 1.5) to
// (2, 1, 3.5).
constexpr const char* kRoomWithAWindow = R"(
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.5 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 -1  2 -1 -1  -2 -1 6  2 -1 6 ]
Shape "bilinearmesh" "point3 P" [ -2 2 -1  2 2 -1  -2 2 6  2 2 6 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 -1  -2 2 -1  -2 -1 6  -2 2 6 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 -1  2 -1 -1  -2 2 -1  2 2 -1 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 6  2 -1 6  -2 2 6  2 2 6 ]
Shape "bilinearmesh" "point3 P" [ 2 -1 -1  2 2 -1  2 -1 1.5  2 2 1.5 ]
Shape "bilinearmesh" "point3 P" [ 2 -1 3.5  2 2 3.5  2 -1 6  2 2 6 ]
Shape "bilinearmesh" "point3 P" [ 2 -1 1.5  2 -0.5 1.5  2 -1 3.5  2 -0.5 3.5 ]
Shape "bilinearmesh" "point3 P" [ 2 1 1.5  2 2 1.5  2 1 3.5  2 2 3.5 ]
AttributeBegin
  Material "conductor" "float roughness" 0.3
  Translate 0.5 -0.3 4
  Shape "sphere" "float radius" 0.6
AttributeEnd
)";
constexpr const char* kWindow = " \"point3 portal\" [ 2 -0.5 1.5  2 -0.5 3.5  2 1 3.5  2 1 1.5 ]\n";

// Two rooms with a gap between them: a ball of smoke and one of metal around the camera, a lamp in the other.
constexpr const char* kRoomLitThroughAGap = R"(
MakeNamedMedium "smoke" "string type" "homogeneous" "rgb sigma_a" [ 0.1 0.1 0.1 ] "rgb sigma_s" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0.8 0.8 0.7 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 -1  2 -1 -1  -2 -1 9  2 -1 9 ]
Shape "bilinearmesh" "point3 P" [ -2 2 -1  2 2 -1  -2 2 9  2 2 9 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 -1  -2 2 -1  -2 -1 9  -2 2 9 ]
Shape "bilinearmesh" "point3 P" [ 2 -1 -1  2 2 -1  2 -1 9  2 2 9 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 -1  2 -1 -1  -2 2 -1  2 2 -1 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 9  2 -1 9  -2 2 9  2 2 9 ]
Shape "bilinearmesh" "point3 P" [ -2 -1 5  1.2 -1 5  -2 2 5  1.2 2 5 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 40 40 30 ] "bool twosided" true
  Shape "bilinearmesh" "point3 P" [ -1.9 0 6  -1.9 1.5 6  -1.9 0 8  -1.9 1.5 8 ]
AttributeEnd
AttributeBegin
  MediumInterface "smoke" ""
  Material "interface"
  Translate 0.9 0.5 3
  Shape "sphere" "float radius" 0.8
AttributeEnd
AttributeBegin
  Material "conductor" "float roughness" 0.3
  Translate -0.8 -0.2 3.5
  Shape "sphere" "float radius" 0.8
AttributeEnd
)";

// Inside an emitter, with a lamp that is half transparent and one that emits a picture.
constexpr const char* kInsideALamp = R"(
Material "diffuse" "rgb reflectance" [ 0.4 0.4 0.4 ]
AttributeBegin
  ReverseOrientation
  AreaLightSource "diffuse" "rgb L" [ 0.3 0.2 0.1 ]
  Shape "sphere" "float radius" 6
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 3 2 1 ]
  Translate 0.5 0.5 4
  Shape "disk" "float radius" 1 "float alpha" 0.4
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "string filename" "sky.pfm" "bool twosided" true
  Shape "bilinearmesh" "point3 P" [ -2 -1 3  0 -1 3  -2 -1 5  0 -1 5 ]
AttributeEnd
)";

// A ball of coloured smoke, glass with an absorbing interior and thin emissive fog around a lamp.
constexpr const char* kSmoke = R"(
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.02 0.02 0.04 ] "rgb sigma_s" [ 0.05 0.06 0.08 ]
  "rgb Le" [ 0.2 0.1 0.1 ] "float g" 0.3
MakeNamedMedium "smoke" "string type" "homogeneous" "rgb sigma_a" [ 0.1 0.3 0.8 ] "rgb sigma_s" [ 2 1.5 1 ] "float g" -0.2
MakeNamedMedium "juice" "string type" "homogeneous" "rgb sigma_a" [ 0.2 1 2 ] "rgb sigma_s" [ 0 0 0 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.6 ]
AttributeBegin
  MediumInterface "" "fog"
  Shape "bilinearmesh" "point3 P" [ -4 -1 -1  4 -1 -1  -4 -1 8  4 -1 8 ]
  Shape "bilinearmesh" "point3 P" [ -4 -1 8  4 -1 8  -4 4 8  4 4 8 ]
  AreaLightSource "diffuse" "rgb L" [ 6 6 5 ]
  Translate 0 1.8 3.5
  Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
  MediumInterface "smoke" "fog"
  Material "interface"
  Translate -0.8 0 4
  Shape "sphere" "float radius" 0.9
AttributeEnd
AttributeBegin
  MediumInterface "juice" "fog"
  Material "dielectric" "float eta" 1.4
  Translate 1 -0.1 4
  Shape "sphere" "float radius" 0.8
AttributeEnd
)";

// Lamps in a ball of coloured fog that absorbs, in front of a wall and under a sky: one that does not light
// the fog, and one of three triangles. An empty ball is in front of them and one of glass among them.
constexpr const char* kLampsInFog = R"(
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.02 0.05 0.2 ] "rgb sigma_s" [ 0.4 0.2 0.1 ] "float g" 0.3
LightSource "infinite" "rgb L" [ 0.05 0.06 0.08 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.6 ]
AttributeBegin
  MediumInterface "fog" ""
  Material "interface"
  Translate 0 0 4
  Shape "sphere" "float radius" 3.5
AttributeEnd

Shape "bilinearmesh" "string name" "wall" "point3 P" [ -4 -4 6  4 -4 6  -4 4 6  4 4 6 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 9 9 7 ] "string link_include" "wall"
  Translate -1 0.8 3
  Shape "sphere" "float radius" 0.3
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 8 6 4 ]
  Translate 0.7 0.7 3
  Shape "sphere" "float radius" 0.25
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 9 9 9 ]
  Shape "trianglemesh" "point3 P" [ -0.5 -0.8 2  0 -0.8 2.1  -0.5 -0.9 2.5  0 -0.7 2.6  -0.3 -0.6 2.9 ]
    "integer indices" [ 0 1 2 1 3 2 2 3 4 ]
AttributeEnd
AttributeBegin
  MediumInterface "" "fog"
  Material "interface"
  Translate 0.2 0.3 1.8
  Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
  MediumInterface "" "fog"
  Material "dielectric" "float eta" 1.5
  Translate 0.6 -0.5 3
  Shape "sphere" "float radius" 0.4
AttributeEnd
)";

// Lights that illuminate some objects only, on surfaces that scatter in all ways.
constexpr const char* kLinkedLights = R"(
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.5 0.3 ] "float roughness" 0.1
Shape "bilinearmesh" "string name" "floor" "point3 P" [ -4 -1 0  4 -1 0  -4 -1 8  4 -1 8 ]
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ] "string link_exclude" [ "floor" ]
LightSource "infinite" "string filename" "sky.pfm" "string link_include" [ "fl*" "mirror" ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 9 3 1 ] "string link_exclude" [ "ball" ]
  Translate -1.5 1.5 3
  Shape "sphere" "float radius" 0.3
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 1 4 9 ] "string link_include" [ "ball" ]
  Translate 1.5 1.5 3
  Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
  Material "diffuse" "rgb reflectance" [ 0.7 0.7 0.7 ]
  ObjectBegin "ball" Shape "sphere" "float radius" 0.6 ObjectEnd
  Translate -0.7 -0.4 4
  ObjectInstance "ball"
AttributeEnd
AttributeBegin
  Material "conductor" "float roughness" 0
  Translate 0.9 -0.4 4
  Shape "sphere" "float radius" 0.6 "string asset" "mirror"
AttributeEnd
)";

// Objects that rays of one kind pass, an emitter among them.
constexpr const char* kHiddenObjects = R"(
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.5 0.3 ] "float roughness" 0.1
Shape "bilinearmesh" "point3 P" [ -4 -1 0  4 -1 0  -4 -1 8  4 -1 8 ]
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ] "bool visible_camera" false
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 9 3 1 ]
  Translate -0.8 1 4
  Shape "sphere" "float radius" 0.3 "bool visible_camera" false
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 4 8 9 ]
  Translate 1.5 1.5 3
  Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
  Material "diffuse" "rgb reflectance" [ 0.7 0.7 0.7 ]
  Translate -0.7 -0.4 4
  Shape "sphere" "float radius" 0.6 "bool visible_camera" false
  Translate 0.7 0.1 -1
  Shape "sphere" "float radius" 0.4 "bool visible_indirect" false "float alpha" 0.7
AttributeEnd
AttributeBegin
  Material "dielectric"
  Translate 1 -0.4 4
  Shape "sphere" "float radius" 0.6
AttributeEnd
AttributeBegin
  Material "diffuse" "rgb reflectance" [ 0.2 0.7 0.2 ]
  Translate 1 0.6 3.6
  Shape "sphere" "float radius" 0.3 "bool visible_indirect" false "bool visible_shadow" false
AttributeEnd
)";

// Objects and lights that cast no shadows. Light sampling alone finds what they let through.
constexpr const char* kNoShadows = R"(
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.5 0.3 ] "float roughness" 0.1
Shape "bilinearmesh" "point3 P" [ -4 -1 0  4 -1 0  -4 -1 8  4 -1 8 ]
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
LightSource "infinite" "string filename" "sky.pfm"
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 9 3 1 ] "bool cast_shadows" false
  Translate -0.8 1.5 4
  Shape "sphere" "float radius" 0.3
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 4 8 9 ]
  Translate 1.5 1.5 3
  Shape "sphere" "float radius" 0.6
AttributeEnd
AttributeBegin
  Material "diffuse" "rgb reflectance" [ 0.7 0.7 0.7 ]
  Translate -0.7 -0.2 4
  Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
  Material "diffuse" "rgb reflectance" [ 0.2 0.7 0.2 ]
  Translate 0.8 0 3.6
  Shape "sphere" "float radius" 0.5 "bool visible_shadow" false
  Translate -1.4 0.3 -1
  Shape "sphere" "float radius" 0.3 "bool visible_shadow" false "float alpha" 0.5
AttributeEnd
)";

}  // namespace tessera
