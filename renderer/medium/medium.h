// All media of a scene.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "renderer/description/file_source.h"
#include "renderer/description/scene_description.h"
#include "renderer/medium/homogeneous_medium.h"

namespace tessera {

// By the index of SceneDescription::media. Immutable.
class MediumTable {
 public:
  // What to do with kinds of media that are known but not supported.
  enum class Unsupported {
    kRefuse,
    kIgnore,  // an integrator that does not follow media: only what is supported is checked
  };
  static Result<MediumTable> Build(const SceneDescription& scene, Unsupported unsupported, FileSource& files,
                                   Diagnostics& diagnostics);

  const HomogeneousMedium& operator[](int medium) const { return media_[static_cast<size_t>(medium)]; }
  bool empty() const { return media_.empty(); }
  // Whether any of them glows.
  bool is_emissive() const { return std::ranges::any_of(media_, &HomogeneousMedium::is_emissive); }
  size_t size() const { return media_.size(); }

 private:
  std::vector<HomogeneousMedium> media_;
};

}  // namespace tessera
