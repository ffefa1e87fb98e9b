// Which mattes (--aov cryptomatte) the points of a scene belong to: the ids of the object, the material and
// the asset of what a ray hits, and their names for the header of the picture.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "renderer/description/diagnostics.h"
#include "renderer/scene/matte_names.h"
#include "renderer/shape/geometry.h"

namespace tessera {

enum class MatteKind { kObject, kMaterial, kAsset };

// The layer of the file.
constexpr const char* MatteLayer(MatteKind kind) {
  constexpr const char* kLayers[] = {"CryptoObject", "CryptoMaterial", "CryptoAsset"};
  return kLayers[static_cast<size_t>(kind)];
}

// Immutable once built.
class MatteTable {
 public:
  MatteTable() = default;  // of a frame without mattes
  // The geometry must outlive the table.
  MatteTable(const SceneNames& names, const Geometry& geometry);

  // As Cryptomatte has it: never zero.
  float IdOf(MatteKind kind, const Hit& hit) const;

  // Adds what the header of a picture says of the layer. Names that have no room are reported by a warning at
  // `place`.
  void AddAttributes(MatteKind kind, const std::string& place, Diagnostics& diagnostics,
                     std::map<std::string, std::string>& attributes) const;

 private:
  struct Ids {
    float object = 0, asset = 0;  // 0: those of the instance
  };
  void NameShapes(const SceneNames& names);
  void NameInstances(const SceneNames& names);
  void NameMaterials(const SceneNames& names);
  std::vector<std::string>& NamesOf(MatteKind kind) { return names_[static_cast<size_t>(kind)]; }

  const Geometry* geometry_ = nullptr;
  std::vector<Ids> shapes_;                        // by SurfaceProperties::name
  std::vector<Ids> instances_;                     // by index in the geometry
  std::vector<float> materials_;                   // by index
  std::array<std::vector<std::string>, 3> names_;  // by kind, in the order of the scene
};

}  // namespace tessera
