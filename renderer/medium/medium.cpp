#include "renderer/medium/medium.h"

namespace tessera {
namespace {

using MediumReader = Medium (*)(ParameterReader&, const Transform&, FileSource&, Diagnostics&);

template <typename MediumType>
Medium Read(ParameterReader& reader, const Transform& render_from_medium, FileSource& files,
            Diagnostics& diagnostics) {
  return Medium(MediumType::Read(reader, render_from_medium, files, diagnostics));
}

constexpr Kind<MediumReader> kKinds[] = {
    {"homogeneous", Support::kSupported, Read<HomogeneousMedium>},
    {"uniformgrid", Support::kSupported, Read<UniformGridMedium>},
    {"rgbgrid", Support::kSupported, Read<RgbGridMedium>},
    {"cloud", Support::kSupported, Read<CloudMedium>},
    {"nanovdb", Support::kSupported, Read<NanoVdbMedium>},
};
constexpr KindTable<MediumReader> kTable("medium", kKinds);

}  // namespace

KindList MediumKinds() {
  return kTable.List();
}

Result<MediumTable> MediumTable::Build(const SceneDescription& scene, const Transform& render_from_world,
                                       FileSource& files, Diagnostics& diagnostics) {
  MediumTable table;
  table.media_.reserve(scene.media.size());
  for (const MediumDescription& description : scene.media) {
    const Entity& entity = description.entity;
    const Kind<MediumReader>* kind = kTable.Find(entity.kind);
    if (kind == nullptr) return ErrorAt(entity.location, kTable.Refusal(entity.kind));
    ParameterReader reader(entity);
    const Transform render_from_medium = render_from_world * description.world_from_medium;
    table.media_.push_back(kind->reader(reader, render_from_medium, files, diagnostics));
    if (const Result<void> finished = reader.Finish(); !finished) return finished.error();
  }
  return table;
}

}  // namespace tessera
