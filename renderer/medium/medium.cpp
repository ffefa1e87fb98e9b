#include "renderer/medium/medium.h"

#include <algorithm>
#include <array>

#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 5> kKinds = {"homogeneous", "uniformgrid", "rgbgrid", "cloud",
                                                    "nanovdb"};

Error WhyNot(const Entity& entity) {
  const std::string name = "medium \"" + entity.kind + "\"";
  const bool known = std::find(kKinds.begin(), kKinds.end(), entity.kind) != kKinds.end();
  if (!known) return ErrorAt(entity.location, "unknown " + name + DidYouMean(entity.kind, kKinds));
  return ErrorAt(entity.location,
                 name + " is not supported yet (integrator \"path\" renders the scene without media)");
}

}  // namespace

Result<MediumTable> MediumTable::Build(const SceneDescription& scene, Unsupported unsupported,
                                       FileSource& files, Diagnostics& diagnostics) {
  MediumTable table;
  table.media_.reserve(scene.media.size());
  for (const MediumDescription& description : scene.media) {
    const Entity& entity = description.entity;
    if (entity.kind != "homogeneous") {
      const bool ignore = unsupported == Unsupported::kIgnore;
      if (!ignore || std::find(kKinds.begin(), kKinds.end(), entity.kind) == kKinds.end())
        return WhyNot(entity);
      table.media_.emplace_back();
      continue;
    }
    ParameterReader reader(entity);
    table.media_.push_back(HomogeneousMedium::Read(reader, files, diagnostics));
    if (const Result<void> finished = reader.Finish(); !finished) return finished.error();
  }
  return table;
}

}  // namespace tessera
