#include "scene/world_builder.h"

#include <map>

#include "shape/shape_builder.h"
#include "texture/texture_builder.h"

namespace tessera {
namespace {

class WorldBuilder {
 public:
  WorldBuilder(const WorldRequest& request, World* world, std::vector<std::string>* warnings)
      : request_(request),
        scene_(request.scene),
        world_(*world),
        warnings_(*warnings),
        render_from_world_(world->camera.render_from_world()),
        textures_(request.files, request.images, render_from_world_) {}

  Result<void> Build();

 private:
  Result<void> RefuseMedia() const;
  // Appends the shapes of one directive; each is remembered in `sources` if it is not null.
  Result<void> AddShape(const ShapeDescription& description, const Transform& transform,
                        std::vector<Shape>* shapes, std::vector<const ShapeDescription*>* sources);
  Result<void> AddGroups();
  Result<void> AddInstances();

  const WorldRequest& request_;
  const SceneDescription& scene_;
  World& world_;
  std::vector<std::string>& warnings_;
  Transform render_from_world_;
  TextureBuilder textures_;
  std::map<std::string, int> group_index_;
};

// Media that an integrator would have to follow.
Result<void> WorldBuilder::RefuseMedia() const {
  if (!request_.with_media) return {};
  const auto refuse = [](const SourceLocation& where, const std::string& name) {
    return ErrorAt(where, "media are not supported yet: medium \"" + name +
                              "\" (integrator \"path\" renders the scene without media)");
  };
  if (!scene_.camera_medium.empty()) return refuse(scene_.camera.location, scene_.camera_medium);
  for (const ShapeDescription& shape : scene_.shapes) {
    if (!shape.inside_medium.empty()) return refuse(shape.entity.location, shape.inside_medium);
    if (!shape.outside_medium.empty()) return refuse(shape.entity.location, shape.outside_medium);
  }
  for (const ObjectDescription& object : scene_.objects) {
    for (const ShapeDescription& shape : object.shapes) {
      if (!shape.inside_medium.empty()) return refuse(shape.entity.location, shape.inside_medium);
    }
  }
  return {};
}

Result<void> WorldBuilder::AddShape(const ShapeDescription& description, const Transform& transform,
                                    std::vector<Shape>* shapes,
                                    std::vector<const ShapeDescription*>* sources) {
  Result<std::vector<Shape>> built =
      BuildShape(description, transform, request_.files, textures_, &warnings_);
  if (!built) return built.error();
  for (Shape& shape : *built) {
    shape.surface.material = description.material.index;
    shape.surface.is_interface = world_.materials.IsInterface(description.material.index);
    if (sources != nullptr) shape.description = static_cast<int>(&description - scene_.shapes.data());
    shapes->push_back(std::move(shape));
    if (sources != nullptr) sources->push_back(&description);
  }
  return {};
}

Result<void> WorldBuilder::AddGroups() {
  for (const ObjectDescription& object : scene_.objects) {
    ShapeGroup group;
    for (const ShapeDescription& shape : object.shapes) {
      if (shape.area_light) {
        warnings_.push_back(
            shape.area_light->location.Text() +
            ": area lights inside object definitions are not supported: the shape does not emit");
      }
      if (Result<void> added = AddShape(shape, Transform(), &group.shapes, nullptr); !added) return added;
    }
    group_index_[object.name] = static_cast<int>(world_.geometry.groups.size());
    world_.geometry.groups.push_back(std::move(group));
  }
  return {};
}

Result<void> WorldBuilder::AddInstances() {
  for (const InstanceDescription& instance : scene_.instances) {
    const auto group = group_index_.find(instance.name);
    if (group == group_index_.end()) {
      return ErrorAt(instance.location, "object \"" + instance.name + "\" is not defined");
    }
    if (instance.world_from_object.IsAnimated()) {
      return ErrorAt(instance.location, "moving instances are not supported yet");
    }
    if (world_.geometry.groups[group->second].shapes.empty()) continue;
    world_.geometry.instances.push_back(
        {group->second, render_from_world_ * instance.world_from_object.start});
  }
  return {};
}

Result<void> WorldBuilder::Build() {
  if (Result<void> media = RefuseMedia(); !media) return media;
  if (Result<void> added = textures_.Add(scene_); !added) return added;
  Result<MaterialTable> materials = MaterialTable::Build(scene_, textures_);
  if (!materials) return materials.error();
  world_.materials = std::move(*materials);

  std::vector<const ShapeDescription*> sources;
  for (const ShapeDescription& shape : scene_.shapes) {
    if (Result<void> added = AddShape(shape, render_from_world_, &world_.geometry.shapes, &sources); !added)
      return added;
  }
  if (Result<void> added = AddGroups(); !added) return added;
  if (Result<void> added = AddInstances(); !added) return added;

  world_.textures = textures_.Finish();
  const LightInputs inputs{scene_, sources, render_from_world_, request_.light_sampler, request_.files, request_.images,
                           world_.textures};
  Result<LightTable> lights = LightTable::Build(inputs, world_.geometry, &warnings_);
  if (!lights) return lights.error();
  world_.lights = std::move(*lights);
  return {};
}

}  // namespace

Result<void> BuildWorld(const WorldRequest& request, World* world, std::vector<std::string>* warnings) {
  return WorldBuilder(request, world, warnings).Build();
}

}  // namespace tessera
