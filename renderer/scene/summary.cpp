#include "renderer/scene/summary.h"

namespace tessera {
namespace {

// A zero for each form, in the order of Form.
template <typename... Forms>
std::vector<PrimitiveTotal> EmptyTotals(const std::variant<Forms...>*) {
  return {PrimitiveTotal{std::string(Forms::kPrimitives), 0}...};
}

void CountShape(const Shape& shape, SceneSummary* summary) {
  ++summary->shapes;
  summary->geometry_bytes += sizeof(Shape) + shape.Bytes();
  summary->primitives[shape.form.index()].count += shape.PrimitiveCount();
}

}  // namespace

void Summarize(const SceneDescription& scene, const World& world, const ImageCache& images,
               SceneSummary* summary) {
  summary->primitives = EmptyTotals(static_cast<const Form*>(nullptr));
  for (const Shape& shape : world.geometry.shapes) CountShape(shape, summary);
  for (const ShapeGroup& group : world.geometry.groups) {
    for (const Shape& shape : group.shapes) CountShape(shape, summary);
  }
  summary->groups = world.geometry.groups.size();
  summary->instances = world.geometry.instances.size();
  summary->lights = world.lights.size();
  summary->materials = scene.materials.size();
  summary->textures = scene.textures.size();
  summary->media = scene.media.size();
  summary->image_bytes = images.bytes() + world.textures.bytes();
}

}  // namespace tessera
