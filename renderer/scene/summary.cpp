#include "renderer/scene/summary.h"

namespace tessera {
namespace {

template <typename T>
uint64_t Bytes(const std::vector<T>& list) {
  return list.size() * sizeof(T);
}

void CountShape(const Shape& shape, SceneSummary* summary) {
  ++summary->shapes;
  summary->geometry_bytes += sizeof(Shape);
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape.form)) {
    summary->triangles += mesh->indices.size() / 3;
    summary->geometry_bytes +=
        Bytes(mesh->P) + Bytes(mesh->N) + Bytes(mesh->S) + Bytes(mesh->uv) + Bytes(mesh->indices);
  } else if (const auto* patches = std::get_if<BilinearMesh>(&shape.form)) {
    summary->patches += patches->indices.size() / 4;
    summary->geometry_bytes +=
        Bytes(patches->P) + Bytes(patches->N) + Bytes(patches->uv) + Bytes(patches->indices);
  } else {
    ++summary->quadrics;
  }
}

}  // namespace

void Summarize(const SceneDescription& scene, const World& world, const ImageCache& images,
               SceneSummary* summary) {
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
