#include "renderer/scene/world_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "renderer/math/flat_transform.h"
#include "renderer/scene/scene_links.h"
#include "renderer/shape/curve_budget.h"
#include "renderer/shape/made_triangles.h"
#include "renderer/shape/reach.h"
#include "renderer/shape/shape_builder.h"
#include "renderer/texture/texture_builder.h"
#include "renderer/util/load_budget.h"

namespace tessera {
namespace {

bool MakesTriangles(const Entity& shape) {
  const auto is_displacement = [](const Parameter& parameter) { return parameter.name == "displacement"; };
  return shape.kind == "loopsubdiv" ||
         (shape.kind == "plymesh" && std::ranges::any_of(shape.parameters, is_displacement));
}

class WorldBuilder {
 public:
  WorldBuilder(const WorldRequest& request, World* world, Diagnostics& diagnostics)
      : request_(request),
        scene_(request.scene),
        world_(*world),
        diagnostics_(diagnostics),
        render_from_world_(world->camera.render_from_world()),
        textures_(request.files, request.images, diagnostics, render_from_world_) {
    if (request.average_images) textures_.AverageImages();
  }

  Result<std::vector<EmittingShape>> Build();

 private:
  Result<void> AddMedia();
  int MediumIndex(const std::string& name) const;
  // The shapes of one directive, complete but for SurfaceProperties::area_light.
  // `object`: the object definition; empty for shapes of the world.
  Result<std::vector<Shape>> MakeShapes(const ShapeDescription& description, const Transform& transform,
                                        const std::string& object);
  // Shapes of an object definition, or of the world, that stand still or move in the same way.
  struct Part {
    int group = 0;
    AnimatedTransform object_from_part;
    SourceLocation location;                      // of its first shape
    size_t emitters_begin = 0, emitters_end = 0;  // its own, of emitters_
  };
  int AddGroup();
  Result<void> AddToGroup(const ShapeDescription& description, int group, const std::string& object);
  // Adds what a directive made to `present`, the shapes of a space.
  void Append(std::vector<Shape>&& shapes, const ShapeDescription& description, std::vector<Shape>& present);
  // Adds a shape that moves to the last of `parts`, or to a new part if that moves in another way.
  Result<void> AddMovingShape(const ShapeDescription& description, std::vector<Part>& parts,
                              const std::string& object);
  Result<void> AddShapes();
  Result<void> AddGroups();
  Result<void> AddInstances();
  Result<void> AddInstance(const Part& part, const AnimatedTransform& world_from_object,
                           const SourceLocation& place);
  Result<void> AddMovingInstance(const Part& part, const AnimatedTransform& world_from_object,
                                 const SourceLocation& place);
  const Bounds3& BoundsOfGroup(int group);
  void LimitCurves();
  Result<void> AddLights();

  const WorldRequest& request_;
  const SceneDescription& scene_;
  World& world_;
  Diagnostics& diagnostics_;
  Transform render_from_world_;
  TextureBuilder textures_;
  std::map<std::string, int> medium_index_;
  std::map<std::string, std::vector<Part>> objects_;  // by name
  std::vector<Part> moving_shapes_;                   // of the world
  std::map<int, Bounds3> group_bounds_;               // of those that move
  std::vector<EmittingShape> emitters_;
  SceneLinks links_;
  uint64_t made_triangles_ = 0;  // by subdivision and displacement
  bool has_media_ = false;       // whether any ray can be in a medium
};

// Media are checked even where they are not followed.
Result<void> WorldBuilder::AddMedia() {
  Result<MediumTable> media = MediumTable::Build(scene_, render_from_world_, request_.files, diagnostics_);
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
                                                    const Transform& transform, const std::string& object) {
  SurfaceProperties surface;
  surface.material = description.material.index;
  if (request_.names != nullptr) surface.name = request_.names->IndexOf(description);
  surface.is_interface = world_.materials.IsInterface(description.material.index);
  surface.needs_tangents = world_.materials.NeedsTangents(description.material.index);
  surface.needs_normal_derivatives = world_.materials.NeedsNormalDerivatives(description.material.index);
  surface.inside_medium = MediumIndex(description.inside_medium);
  surface.outside_medium = MediumIndex(description.outside_medium);
  has_media_ |= surface.inside_medium != surface.outside_medium;
  world_.has_interfaces |= surface.is_interface;
  surface.light_links = links_.LinksOf(description, object);
  auto shapes = BuildShape(description, surface, transform, request_.files, textures_, diagnostics_);
  if (!shapes) return shapes;
  if (!shapes->empty())
    world_.passes_shadow_rays |= !surface.is_interface && !shapes->front().surface.StopsShadowRays();
  if (!MakesTriangles(description.entity)) return shapes;
  for (const Shape& shape : *shapes) made_triangles_ += shape.PrimitiveCount();
  if (made_triangles_ > kMadeTrianglesMax) {
    return ErrorAt(
        description.entity.location,
        fmt::format("up to here the scene makes {} triangles by subdivision and displacement; at most "
                    "{} are possible",
                    made_triangles_, kMadeTrianglesMax));
  }
  return shapes;
}

int WorldBuilder::AddGroup() {
  world_.geometry.groups.emplace_back();
  return static_cast<int>(world_.geometry.groups.size()) - 1;
}

Result<void> WorldBuilder::AddToGroup(const ShapeDescription& description, int group,
                                      const std::string& object) {
  CheckLoadBudget();
  Result<std::vector<Shape>> shapes = MakeShapes(description, Transform(), object);
  if (!shapes) return shapes.error();
  Append(*std::move(shapes), description, world_.geometry.groups[group].shapes);
  return {};
}

void WorldBuilder::Append(std::vector<Shape>&& shapes, const ShapeDescription& description,
                          std::vector<Shape>& present) {
  for (Shape& shape : shapes) {
    // Lights are made of whole directives.
    const bool may_merge = !present.empty() && !description.area_light;
    if (may_merge && MergeCurves(shape, &present.back())) continue;
    if (description.area_light)
      emitters_.push_back({&description, static_cast<uint32_t>(present.size()), Hit::kNoInstance});
    present.push_back(std::move(shape));
  }
}

Result<void> WorldBuilder::AddMovingShape(const ShapeDescription& description, std::vector<Part>& parts,
                                          const std::string& object) {
  if (parts.empty() || !(parts.back().object_from_part == description.world_from_object))
    parts.push_back({AddGroup(), description.world_from_object, description.entity.location, emitters_.size(),
                     emitters_.size()});
  Result<void> added = AddToGroup(description, parts.back().group, object);
  parts.back().emitters_end = emitters_.size();
  return added;
}

Result<void> WorldBuilder::AddShapes() {
  for (const ShapeDescription& description : scene_.shapes) {
    CheckLoadBudget();
    if (description.world_from_object.IsAnimated()) continue;
    Result<std::vector<Shape>> shapes = MakeShapes(description, render_from_world_, "");
    if (!shapes) return shapes.error();
    Append(*std::move(shapes), description, world_.geometry.shapes);
  }
  return {};
}

Result<void> WorldBuilder::AddGroups() {
  for (const ObjectDescription& object : scene_.objects) {
    std::vector<Part>& parts = objects_[object.name];
    const int still = AddGroup();
    parts.push_back({still, AnimatedTransform(), object.location});
    for (const ShapeDescription& shape : object.shapes) {
      const bool moves = shape.world_from_object.IsAnimated();
      Result<void> added =
          moves ? AddMovingShape(shape, parts, object.name) : AddToGroup(shape, still, object.name);
      if (!added) return added;
    }
  }
  for (const ShapeDescription& shape : scene_.shapes) {
    if (!shape.world_from_object.IsAnimated()) continue;
    if (Result<void> added = AddMovingShape(shape, moving_shapes_, ""); !added) return added;
  }
  return {};
}

Result<void> WorldBuilder::AddInstances() {
  for (size_t i = 0; i < scene_.instances.size(); ++i) {
    const InstanceDescription& instance = scene_.instances[i];
    CheckLoadBudget();
    const auto object = objects_.find(instance.name);
    if (object == objects_.end()) {
      return ErrorAt(instance.location, "object \"" + instance.name + "\" is not defined");
    }
    for (const Part& part : object->second) {
      if (Result<void> added = AddInstance(part, instance.world_from_object, instance.location); !added)
        return added;
    }
    if (request_.names != nullptr)
      request_.names->NoteInstances(world_.geometry.instances.size(), static_cast<int>(i));
  }
  for (const Part& part : moving_shapes_) {
    if (Result<void> added = AddMovingInstance(part, AnimatedTransform(), part.location); !added)
      return added;
    const auto instance = static_cast<uint32_t>(world_.geometry.instances.size()) - 1;
    for (size_t i = part.emitters_begin; i < part.emitters_end; ++i) emitters_[i].instance = instance;
  }
  if (request_.names != nullptr) request_.names->NoteMovingShapes(world_.geometry.instances.size());
  return {};
}

Result<void> WorldBuilder::AddInstance(const Part& part, const AnimatedTransform& world_from_object,
                                       const SourceLocation& place) {
  if (world_.geometry.groups[part.group].shapes.empty()) return {};
  if (!world_from_object.IsAnimated() && IsFlat(world_from_object.Fixed())) {
    diagnostics_.Warn(place, "the object is not shown: its transformation has no inverse");
    return {};
  }
  if (world_from_object.IsAnimated() || part.object_from_part.IsAnimated())
    return AddMovingInstance(part, world_from_object, place);
  const Transform render_from_object = WithExactInverse(render_from_world_ * world_from_object.Fixed());
  if (!IsReachable(render_from_object)) {
    diagnostics_.Warn(place, "the object is not shown: it is too small, too large or too far away");
    return {};
  }
  world_.geometry.instances.push_back({part.group, render_from_object});
  return {};
}

Result<void> WorldBuilder::AddMovingInstance(const Part& part, const AnimatedTransform& world_from_object,
                                             const SourceLocation& place) {
  Geometry& geometry = world_.geometry;
  const AnimatedTransform factors[] = {AnimatedTransform(render_from_world_), world_from_object,
                                       part.object_from_part};
  const Instance instance{part.group, Transform(), static_cast<int>(geometry.motions.size())};
  geometry.motions.emplace_back(factors);
  const Bounds3& of_group = BoundsOfGroup(part.group);
  const Bounds3 bounds = of_group.empty() ? Bounds3() : geometry.InstanceBounds(instance, of_group);
  if (!of_group.empty() && !(IsFinite(bounds.min) && IsFinite(bounds.max)))
    return ErrorAt(place, "what moves here does not stay finite in rendering space");
  geometry.instances.push_back(instance);
  return {};
}

const Bounds3& WorldBuilder::BoundsOfGroup(int group) {
  const auto [found, is_new] = group_bounds_.try_emplace(group);
  if (is_new) {
    for (const Shape& shape : world_.geometry.groups[group].shapes) found->second.Add(shape.Bounds());
  }
  return found->second;
}

void WorldBuilder::LimitCurves() {
  const std::optional<int> depth = LimitCurvePieces(world_.geometry);
  if (!depth) return;
  const auto warn = [&](const std::vector<ShapeDescription>& shapes) {
    for (const ShapeDescription& shape : shapes) {
      for (const Parameter& parameter : shape.entity.parameters) {
        if (parameter.name != "splitdepth" || parameter.integers.empty()) continue;
        if (parameter.integers[0] <= *depth) continue;
        diagnostics_.WarnOnce(
            "splitdepth", parameter.location,
            fmt::format("\"splitdepth\" is lowered to {} for the curves of the scene, which "
                        "would have too many pieces; this changes the speed but not the "
                        "picture",
                        *depth));
        return;
      }
    }
  };
  warn(scene_.shapes);
  for (const ObjectDescription& object : scene_.objects) warn(object.shapes);
}

Result<void> WorldBuilder::AddLights() {
  const LightInputs inputs{scene_,         emitters_,       render_from_world_, request_.light_sampler,
                           request_.files, request_.images, world_.textures,    world_.passes_shadow_rays};
  Result<BuiltLights> lights = LightTable::Build(inputs, world_.geometry, diagnostics_);
  if (!lights) return lights.error();
  for (size_t i = 0; i < emitters_.size(); ++i) {
    ShapeOf(world_.geometry, emitters_[i].instance, emitters_[i].shape).surface.area_light =
        lights->area_lights[i];
  }
  world_.lights = std::move(lights->table);
  world_.links = links_.Assign(world_, emitters_, diagnostics_);
  return {};
}

Result<std::vector<EmittingShape>> WorldBuilder::Build() {
  world_.geometry.times = {world_.camera.shutter_open(), world_.camera.shutter_close()};
  Result<SceneLinks> links = SceneLinks::Read(scene_);
  if (!links) return links.error();
  links_ = *std::move(links);
  if (Result<void> added = AddMedia(); !added) return added.error();
  if (Result<void> added = textures_.Add(scene_); !added) return added.error();
  Result<MaterialTable> materials = MaterialTable::Build(scene_, textures_);
  if (!materials) return materials.error();
  world_.materials = std::move(*materials);
  world_.has_subsurface = world_.materials.AnyScattersBelow();
  if (Result<void> added = AddShapes(); !added) return added.error();
  if (Result<void> added = AddGroups(); !added) return added.error();
  LimitCurves();
  if (Result<void> added = AddInstances(); !added) return added.error();
  const auto moves = [](const LightDescription& light) { return light.world_from_light.IsAnimated(); };
  world_.moves =
      world_.camera.moves() || !world_.geometry.motions.empty() || std::ranges::any_of(scene_.lights, moves);
  if (!has_media_) world_.media = MediumTable();
  world_.textures = textures_.Finish();
  if (Result<void> added = AddLights(); !added) return added.error();
  return std::move(emitters_);
}

}  // namespace

Result<std::vector<EmittingShape>> BuildWorld(const WorldRequest& request, World* world,
                                              Diagnostics& diagnostics) {
  return WorldBuilder(request, world, diagnostics).Build();
}

}  // namespace tessera
