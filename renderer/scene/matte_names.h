// What the shapes of a scene are called in mattes (--aov cryptomatte): the object that a shape is, and the
// asset that it belongs to. client/guide/layers.md has the rules, which depend on the scene files alone:
// frames of a sequence have the same names as long as they have the same directives in the same order.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "renderer/description/scene_description.h"

namespace tessera {

constexpr size_t kMatteNameBytesMax = 255;  // longer names end in their hash instead

// A name as mattes show it, in normal form C: one line of UTF-8 of at most kMatteNameBytesMax bytes.
std::string MatteName(std::string_view name);

// Empty: that of the instance.
struct ShapeName {
  std::string object, asset;
};

// An instance of an object definition.
struct InstanceName {
  int instance = -1;    // index in SceneDescription::instances; -1: a shape that moves by itself
  uint32_t number = 0;  // among those of its definition, from 1
};

// Names the directives of a scene one after another. `Add` returns the index of a name.
class ShapeNamer {
 public:
  ShapeNamer() : names_(1) {}  // that of instanced shapes without a name of their own

  // Of a shape of the world, or of an object definition.
  int Add(const ShapeDescription& shape, bool is_instanced);
  const std::vector<ShapeName>& names() const { return names_; }

 private:
  std::vector<ShapeName> names_;
  std::map<std::string, uint32_t> counts_;  // of shapes without a name, by what they are numbered under
  int run_ = 0;  // index of the last name if curves without a name have it and may go on; otherwise 0
};

// The names of a scene whose geometry is being built.
class SceneNames {
 public:
  // The scene must outlive this and stay where it is.
  explicit SceneNames(const SceneDescription& scene);

  // Of the shapes of a directive: index in shapes().
  int IndexOf(const ShapeDescription& shape) const { return index_.at(&shape); }
  // The geometry has this many instances now; those that were added since the last call are of an instance of
  // the scene, or of shapes that move by themselves.
  void NoteInstances(size_t count, int instance);
  void NoteMovingShapes(size_t count) { instances_.resize(count); }

  const std::vector<ShapeName>& shapes() const { return namer_.names(); }
  const std::vector<InstanceName>& instances() const { return instances_; }  // as in the geometry
  const SceneDescription& scene() const { return scene_; }

 private:
  const SceneDescription& scene_;
  ShapeNamer namer_;
  std::map<const ShapeDescription*, int> index_;
  std::vector<uint32_t> numbers_;  // of the scene's instances, by index
  std::vector<InstanceName> instances_;
};

// The names of the materials of a scene, by index.
std::vector<std::string> MaterialNames(const SceneDescription& scene);

}  // namespace tessera
