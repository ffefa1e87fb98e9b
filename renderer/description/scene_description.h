// A scene as a value, whatever language it was written in: entities with their parameters, transforms and
// places, nothing built. Its readers have not interpreted any parameter, and have opened no file but the
// scene files.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/description/diagnostics.h"
#include "renderer/description/embedded_files.h"
#include "renderer/description/mesh_data.h"
#include "renderer/description/source_location.h"
#include "renderer/math/animated_transform.h"

namespace tessera {

// One typed parameter with its values as written.
struct Parameter {
  std::string
      type;  // bool float integer point2 vector2 point3 vector3 normal string texture rgb blackbody spectrum
  std::string name;
  SourceLocation location;
  std::vector<float> floats;  // of all numeric types but integer
  std::vector<int> integers;
  std::vector<std::string> strings;  // of string, texture and named spectra
  std::vector<bool> bools;
  std::string color_space = "srgb";  // of rgb
  bool is_default = false;           // not written for this entity: need not be read
};

// Something of a kind, with parameters: `Shape "sphere" "float radius" 2`.
struct Entity {
  std::string directive;  // "Shape": what messages call it
  std::string kind;       // "sphere"
  SourceLocation location;
  std::vector<Parameter> parameters;
};

struct TextureDescription {
  std::string name;
  bool is_spectrum = false;  // else float
  Entity entity;
  Transform world_from_texture;
};

struct MaterialDescription {
  std::string name;  // empty if no name refers to it
  Entity entity;
};

struct MediumDescription {
  std::string name;
  Entity entity;
  Transform world_from_medium;
};

struct LightDescription {
  Entity entity;
  AnimatedTransform world_from_light;
  std::string outside_medium;
};

// The material of a shape: an index into SceneDescription::materials. DescriptionBuilder fills it in if there
// is a name.
struct MaterialReference {
  int index = 0;
  std::string name;  // empty: the index counts
};

struct ShapeDescription {
  Entity entity;
  // The mesh of a kind that is one. Null: its parameters give it.
  std::shared_ptr<const MeshData> mesh;
  AnimatedTransform world_from_object;  // inside an object definition: object-definition space from object
  bool reverse_orientation = false;
  MaterialReference material;
  std::shared_ptr<const Entity> area_light;  // null: the shape does not emit. Shapes may share it
  std::string inside_medium, outside_medium;
};

// Shapes that instances place in the world.
struct ObjectDescription {
  std::string name;
  SourceLocation location;
  std::vector<ShapeDescription> shapes;
};

struct InstanceDescription {
  std::string name;  // of the object
  SourceLocation location;
  AnimatedTransform world_from_object;
};

struct SceneDescription {
  Entity camera, film, filter, sampler, integrator, accelerator;
  AnimatedTransform camera_from_world;
  std::string camera_medium;
  std::string film_color_space = "srgb";
  std::vector<Parameter> options;  // OptionKinds

  std::vector<TextureDescription> textures;    // each after those that it refers to
  std::vector<MaterialDescription> materials;  // materials[0] is the default one
  std::map<std::string, int> named_materials;  // name -> index into materials
  std::vector<MediumDescription> media;
  std::vector<LightDescription> lights;
  std::vector<ShapeDescription> shapes;
  std::vector<ObjectDescription> objects;
  std::vector<InstanceDescription> instances;

  EmbeddedFiles embedded_files;

  Diagnostics diagnostics;  // what its readers reported
};

}  // namespace tessera
