// A scene as its text describes it: every directive carried out (transforms, attributes, includes), nothing
// built. A plain value: no file but the text has been read and no parameter has been interpreted.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/description/diagnostics.h"
#include "renderer/description/source_location.h"
#include "renderer/math/transform.h"

namespace tessera {

// One "type name" value parameter, with its values as written.
struct Parameter {
  std::string type;  // "float", "rgb", ...: one of the type words of the language
  std::string name;
  SourceLocation location;
  std::vector<float> floats;  // of all numeric types but integer
  std::vector<int> integers;
  std::vector<std::string> strings;  // of string, texture and named spectra
  std::vector<bool> bools;
  std::string color_space = "srgb";  // of rgb: the one current where it was written
  bool from_attribute = false;       // a default set by Attribute: may stay unused
};

// A directive with a kind and parameters: `Shape "sphere" "float radius" 2`.
struct Entity {
  std::string directive;  // "Shape"
  std::string kind;       // "sphere"
  SourceLocation location;
  std::vector<Parameter> parameters;
};

// The transforms at the start and end of the shutter. Equal unless the scene asks for motion.
struct TransformPair {
  Transform start, end;
  bool IsAnimated() const { return !(start == end); }
};

struct TextureDescription {
  std::string name;
  bool is_spectrum = false;  // else float
  Entity entity;             // kind is "imagemap", ...
  TransformPair world_from_texture;
};

struct MaterialDescription {
  std::string name;  // of a named material; empty for one in place
  Entity entity;
};

struct MediumDescription {
  std::string name;
  Entity entity;
  TransformPair world_from_medium;
};

struct LightDescription {
  Entity entity;
  TransformPair world_from_light;
  std::string outside_medium;
};

// Which material a shape has: an index into `materials`, or a name that may be defined later in the file.
struct MaterialReference {
  int index = 0;
  std::string name;  // not empty: a named material
};

struct ShapeDescription {
  Entity entity;
  TransformPair world_from_object;  // inside an object definition: object-definition space from object
  bool reverse_orientation = false;
  MaterialReference material;
  std::optional<Entity> area_light;
  std::string inside_medium, outside_medium;
};

struct ObjectDescription {  // ObjectBegin ... ObjectEnd
  std::string name;
  SourceLocation location;
  std::vector<ShapeDescription> shapes;
};

struct InstanceDescription {  // ObjectInstance
  std::string name;
  SourceLocation location;
  TransformPair world_from_object;
};

struct SceneDescription {
  Entity camera, film, filter, sampler, integrator, accelerator;  // kind is the default's where not given
  TransformPair camera_from_world;
  std::string camera_medium;
  std::string film_color_space = "srgb";
  float shutter_start_time = 0, shutter_end_time = 1;  // TransformTimes
  std::vector<Parameter> options;                      // Option: name lower case without '-' and '_'

  std::vector<TextureDescription> textures;  // in order of definition
  // materials[0] is the default diffuse one. In place ones and named ones share the list.
  std::vector<MaterialDescription> materials;
  std::map<std::string, int> named_materials;  // name -> index into materials
  std::vector<MediumDescription> media;
  std::vector<LightDescription> lights;
  std::vector<ShapeDescription> shapes;
  std::vector<ObjectDescription> objects;
  std::vector<InstanceDescription> instances;

  Diagnostics diagnostics;  // what its readers reported
};

}  // namespace tessera
