#include "renderer/scene/mattes.h"

#include <fmt/format.h>

#include "renderer/film/cryptomatte.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr const char* kMattePlurals[] = {"objects", "materials", "assets"};

float IdOrNone(const std::string& name) {
  return name.empty() ? 0 : MatteId(name);
}

}  // namespace

MatteTable::MatteTable(const SceneNames& names, const Geometry& geometry) : geometry_(&geometry) {
  NameShapes(names);
  NameInstances(names);
  NameMaterials(names);
}

void MatteTable::NameShapes(const SceneNames& names) {
  for (const ShapeName& name : names.shapes()) {
    shapes_.push_back({IdOrNone(name.object), IdOrNone(name.asset)});
    if (!name.object.empty()) NamesOf(MatteKind::kObject).push_back(name.object);
    if (!name.asset.empty()) NamesOf(MatteKind::kAsset).push_back(name.asset);
  }
}

void MatteTable::NameInstances(const SceneNames& names) {
  int last = -1;  // an object of several parts is several instances of the geometry
  for (const InstanceName& each : names.instances()) {
    if (each.instance < 0) {
      instances_.emplace_back();
      continue;
    }
    const std::string asset = MatteName(names.scene().instances[static_cast<size_t>(each.instance)].name);
    const std::string object = fmt::format("{}.{}", asset, each.number);
    instances_.push_back({MatteId(object), MatteId(asset)});
    if (each.instance == last) continue;
    last = each.instance;
    NamesOf(MatteKind::kObject).push_back(object);
    if (each.number == 1) NamesOf(MatteKind::kAsset).push_back(asset);
  }
}

void MatteTable::NameMaterials(const SceneNames& names) {
  std::vector<bool> is_used(names.scene().materials.size());
  const auto use = [&](const std::vector<Shape>& shapes) {
    for (const Shape& shape : shapes) is_used[static_cast<size_t>(shape.surface.material)] = true;
  };
  use(geometry_->shapes);
  for (const ShapeGroup& group : geometry_->groups) use(group.shapes);
  const std::vector<std::string> all = MaterialNames(names.scene());
  for (size_t i = 0; i < all.size(); ++i) {
    materials_.push_back(MatteId(all[i]));
    if (is_used[i]) NamesOf(MatteKind::kMaterial).push_back(all[i]);
  }
}

float MatteTable::IdOf(MatteKind kind, const Hit& hit) const {
  const Shape& shape = ShapeOf(*geometry_, hit.instance, hit.shape);
  if (kind == MatteKind::kMaterial) return materials_[static_cast<size_t>(shape.surface.material)];
  const bool is_object = kind == MatteKind::kObject;
  const Ids& own = shapes_[static_cast<size_t>(shape.surface.name)];
  const float id = is_object ? own.object : own.asset;
  if (id != 0) return id;
  const Ids& instance = instances_[hit.instance];
  return is_object ? instance.object : instance.asset;
}

void MatteTable::AddAttributes(MatteKind kind, const std::string& place, Diagnostics& diagnostics,
                               std::map<std::string, std::string>& attributes) const {
  const auto index = static_cast<size_t>(kind);
  const MatteManifest manifest = MakeManifest(names_[index]);
  if (manifest.listed < manifest.total) {
    diagnostics.Warn(place,
                     fmt::format("the picture will name {} of {} {}: its header has room for {} bytes "
                                 "of names; the mattes of the others are there, without a name",
                                 manifest.listed, manifest.total, kMattePlurals[index], kManifestBytesMax));
  }
  AddMatteAttributes(MatteLayer(kind), manifest, attributes);
}

}  // namespace tessera
