#include "renderer/scene/world_builder.h"

#include <map>

#include "renderer/shape/shape_builder.h"
#include "renderer/texture/texture_builder.h"

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
        textures_(request.files, request.images, render_from_world_) {}

  Result<void> Build();

 private:
  Result<void> AddMedia();
  int MediumIndex(const std::string& name) const;
  // Appends the shapes of one directive; each is remembered in `sources` if it is not null.
  Result<void> AddShape(const ShapeDescription& description, const Transform& transform,
                        std::vector<Shape>* shapes, std::vector<const ShapeDescription*>* sources);
  Result<void> AddGroups();
  Result<void> AddInstances();

  const WorldRequest& request_;
  const SceneDescription& scene_;
  World& world_;
  Diagnostics& diagnostics_;
  Transform render_from_world_;
  TextureBuilder textures_;
  std::map<std::string, int> group_index_, medium_index_;
  bool has_media_ = false;  // whether any ray can be in a medium
};

// Media are checked even where they are not followed.
Result<void> WorldBuilder::AddMedia() {
  using Unsupported = MediumTable::Unsupported;
  const Unsupported unsupported = request_.with_media ? Unsupported::kRefuse : Unsupported::kIgnore;
  Result<MediumTable> media = MediumTable::Build(scene_, unsupported, request_.files, diagnostics_);
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

Result<void> WorldBuilder::AddShape(const ShapeDescription& description, const Transform& transform,
                                    std::vector<Shape>* shapes,
                                    std::vector<const ShapeDescription*>* sources) {
  Result<std::vector<Shape>> built =
      BuildShape(description, transform, request_.files, textures_, diagnostics_);
  if (!built) return built.error();
  const int inside = MediumIndex(description.inside_medium),
            outside = MediumIndex(description.outside_medium);
  has_media_ |= inside != outside;
  for (Shape& shape : *built) {
    shape.surface.material = description.material.index;
    shape.surface.is_interface = world_.materials.IsInterface(description.material.index);
    shape.surface.inside_medium = inside;
    shape.surface.outside_medium = outside;
    world_.has_interfaces |= shape.surface.is_interface;
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
    if (world_.geometry.groups[group->second].shapes.empty()) continue;
    world_.geometry.instances.push_back(
        {group->second, render_from_world_ * instance.world_from_object.Fixed()});
  }
  return {};
}

Result<void> WorldBuilder::Build() {
  if (Result<void> added = AddMedia(); !added) return added;
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
  if (!has_media_) world_.media = MediumTable();

  world_.textures = textures_.Finish();
  const LightInputs inputs{scene_,         sources,         render_from_world_, request_.light_sampler,
                           request_.files, request_.images, world_.textures};
  Result<BuiltLights> lights = LightTable::Build(inputs, world_.geometry, diagnostics_);
  if (!lights) return lights.error();
  for (size_t i = 0; i < world_.geometry.shapes.size(); ++i)
    world_.geometry.shapes[i].surface.area_light = lights->area_lights[i];
  world_.lights = std::move(lights->table);
  return {};
}

}  // namespace

Result<void> BuildWorld(const WorldRequest& request, World* world, Diagnostics& diagnostics) {
  return WorldBuilder(request, world, diagnostics).Build();
}

}  // namespace tessera
