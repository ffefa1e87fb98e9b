#include "renderer/medium/medium.h"

namespace tessera {
namespace {

using MediumReader = Medium (*)(ParameterReader&, FileSource&, Diagnostics&);

template <typename MediumType>
Medium Read(ParameterReader& reader, FileSource& files, Diagnostics& diagnostics) {
  return Medium(MediumType::Read(reader, files, diagnostics));
}

constexpr Kind<MediumReader> kKinds[] = {
    {"homogeneous", Support::kSupported, Read<HomogeneousMedium>},
    {"cloud", Support::kNotSupported},
    {"nanovdb", Support::kNotSupported},
    {"rgbgrid", Support::kNotSupported},
    {"uniformgrid", Support::kNotSupported},
};
constexpr KindTable<MediumReader> kTable("medium", kKinds);

}  // namespace

KindList MediumKinds() {
  return kTable.List();
}

Result<MediumTable> MediumTable::Build(const SceneDescription& scene, Unsupported unsupported,
                                       FileSource& files, Diagnostics& diagnostics) {
  MediumTable table;
  table.media_.reserve(scene.media.size());
  for (const MediumDescription& description : scene.media) {
    const Entity& entity = description.entity;
    const Kind<MediumReader>* kind = kTable.Find(entity.kind);
    if (kind == nullptr && !kTable.IsKnown(entity.kind)) {
      return ErrorAt(entity.location, kTable.Refusal(entity.kind));
    }
    if (kind == nullptr && unsupported == Unsupported::kRefuse) {
      return ErrorAt(entity.location,
                     kTable.Refusal(entity.kind) + " (integrator \"path\" renders the scene without media)");
    }
    if (kind == nullptr) {
      table.media_.emplace_back();
      continue;
    }
    ParameterReader reader(entity);
    table.media_.push_back(kind->reader(reader, files, diagnostics));
    if (const Result<void> finished = reader.Finish(); !finished) return finished.error();
  }
  return table;
}

}  // namespace tessera
