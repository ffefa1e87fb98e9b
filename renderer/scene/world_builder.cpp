#include "renderer/scene/world_builder.h"

#include <algorithm>
#include <map>

#include "renderer/math/flat_transform.h"
#include "renderer/shape/shape_builder.h"
#include "renderer/texture/texture_builder.h"
#include "renderer/util/load_budget.h"

namespace tessera {
namespace {

class WorldBuilder {
 public:
  WorldBuilder(const WorldRequest& request, World* world, Diagnostics& diagnostics)
      : request_(request),
        scene_(request.scene),
        world_(*world),
        diagnostics_(diagnostics),
        render_from_world_(world->camera.render_from_world()),
        textures_(request.files, request.images, diagnostics, render_from_world_) {}

  Result<ShapeDescriptions> Build();

 private:
  Result<void> AddMedia();
  int MediumIndex(const std::string& name) const;
  // The shapes of one directive, complete but for SurfaceProperties::area_light.
  Result<std::vector<Shape>> MakeShapes(const ShapeDescription& description, const Transform& transform);
  Result<void> AddShapes();
  Result<void> AddGroups();
  Result<void> AddInstances();
  Result<void> AddLights();

  const WorldRequest& request_;
  const SceneDescription& scene_;
  World& world_;
  Diagnostics& diagnostics_;
  Transform render_from_world_;
  TextureBuilder textures_;
  std::map<std::string, int> group_index_, medium_index_;
  ShapeDescriptions shape_descriptions_;
  bool has_media_ = false;  // whether any ray can be in a medium
};

// Media are checked even where they are not followed.
Result<void> WorldBuilder::AddMedia() {
  Result<MediumTable> media =
      MediumTable::Build(scene_, render_from_world_, request_.files, diagnostics_);
  if (!media) return media.error();
  if (!request_.with_media) return {};
  for (const MediumDescription& medium : scene_.media) {
    const int index = static_cast<int>(medium_index_.size());
    medium_index_[medium.name] = index;
  }
  world_.media = std::move(*media);
  world_.camera_medium = MediumIndex(scene_.camera_medium);
  has_media_ = world_.camera_medium >= 0;
  return {};
}

// -1 for the empty name, and for all where media are not followed. The names of a scene are known to be
// defined.
int WorldBuilder::MediumIndex(const std::string& name) const {
  const auto found = medium_index_.find(name);
  return found == medium_index_.end() ? -1 : found->second;
}

Result<std::vector<Shape>> WorldBuilder::MakeShapes(const ShapeDescription& description,
                                                    const Transform& transform) {
  SurfaceProperties surface;
  surface.material = description.material.index;
  surface.is_interface = world_.materials.IsInterface(description.material.index);
  surface.inside_medium = MediumIndex(description.inside_medium);
  surface.outside_medium = MediumIndex(description.outside_medium);
  has_media_ |= surface.inside_medium != surface.outside_medium;
  world_.has_interfaces |= surface.is_interface;
  return BuildShape(description, surface, transform, request_.files, textures_, diagnostics_);
}

Result<void> WorldBuilder::AddShapes() {
  for (const ShapeDescription& description : scene_.shapes) {
    CheckLoadBudget();
    Result<std::vector<Shape>> shapes = MakeShapes(description, render_from_world_);
    if (!shapes) return shapes.error();
    std::vector<Shape>& present = world_.geometry.shapes;
    for (Shape& shape : *shapes) {
      // Lights are made of whole directives.
      const bool may_merge = !present.empty() && !description.area_light;
      if (may_merge && MergeCurves(shape, &present.back())) continue;
      present.push_back(std::move(shape));
      shape_descriptions_.push_back(&description);
    }
  }
  return {};
}

Result<void> WorldBuilder::AddGroups() {
  for (const ObjectDescription& object : scene_.objects) {
    ShapeGroup group;
    for (const ShapeDescription& shape : object.shapes) {
      CheckLoadBudget();
      Result<std::vector<Shape>> shapes = MakeShapes(shape, Transform());
      if (!shapes) return shapes.error();
      for (Shape& made : *shapes) {
        if (!group.shapes.empty() && MergeCurves(made, &group.shapes.back())) continue;
        group.shapes.push_back(std::move(made));
      }
    }
    group_index_[object.name] = static_cast<int>(world_.geometry.groups.size());
    world_.geometry.groups.push_back(std::move(group));
  }
  return {};
}

Result<void> WorldBuilder::AddInstances() {
  for (const InstanceDescription& instance : scene_.instances) {
    CheckLoadBudget();
    const auto group = group_index_.find(instance.name);
    if (group == group_index_.end()) {
      return ErrorAt(instance.location, "object \"" + instance.name + "\" is not defined");
    }
    if (world_.geometry.groups[group->second].shapes.empty()) continue;
    const Transform& world_from_object = instance.world_from_object.Fixed();
    if (IsFlat(world_from_object)) {
      diagnostics_.Warn(instance.location, "the object is not shown: its transformation has no inverse");
      continue;
    }
    world_.geometry.instances.push_back({group->second, render_from_world_ * world_from_object});
  }
  return {};
}

Result<void> WorldBuilder::AddLights() {
  const LightInputs inputs{scene_,         shape_descriptions_, render_from_world_, request_.light_sampler,
                           request_.files, request_.images,     world_.textures};
  Result<BuiltLights> lights = LightTable::Build(inputs, world_.geometry, diagnostics_);
  if (!lights) return lights.error();
  for (size_t i = 0; i < world_.geometry.shapes.size(); ++i)
    world_.geometry.shapes[i].surface.area_light = lights->area_lights[i];
  world_.lights = std::move(lights->table);
  return {};
}

Result<ShapeDescriptions> WorldBuilder::Build() {
  if (Result<void> added = AddMedia(); !added) return added.error();
  if (Result<void> added = textures_.Add(scene_); !added) return added.error();
  Result<MaterialTable> materials = MaterialTable::Build(scene_, textures_);
  if (!materials) return materials.error();
  world_.materials = std::move(*materials);
  world_.has_subsurface = world_.materials.AnyScattersBelow();
  if (Result<void> added = AddShapes(); !added) return added.error();
  if (Result<void> added = AddGroups(); !added) return added.error();
  if (Result<void> added = AddInstances(); !added) return added.error();
  if (!has_media_) world_.media = MediumTable();
  world_.textures = textures_.Finish();
  if (Result<void> added = AddLights(); !added) return added.error();
  return std::move(shape_descriptions_);
}

}  // namespace

Result<ShapeDescriptions> BuildWorld(const WorldRequest& request, World* world, Diagnostics& diagnostics) {
  return WorldBuilder(request, world, diagnostics).Build();
}

}  // namespace tessera
