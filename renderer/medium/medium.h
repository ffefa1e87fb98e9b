// Media of any kind, and all media of a scene.
#pragma once

#include <algorithm>
#include <variant>
#include <vector>

#include "renderer/description/file_source.h"
#include "renderer/description/kind_table.h"
#include "renderer/description/scene_description.h"
#include "renderer/medium/cloud_medium.h"
#include "renderer/medium/grid_medium.h"
#include "renderer/medium/homogeneous_medium.h"
#include "renderer/medium/nanovdb_medium.h"
#include "renderer/medium/rgb_grid_medium.h"
#include "renderer/util/dispatch.h"

namespace tessera {

// The kinds of medium. Every kind has
//   static Kind Read(ParameterReader&, const Transform& render_from_medium, FileSource&, Diagnostics&);
//   Coefficients At(const SampledWavelengths&) const;     one of MediumCoefficients
//   const PhaseFunction& phase() const;
//   bool is_emissive() const;
using MediumKind =
    std::variant<HomogeneousMedium, UniformGridMedium, RgbGridMedium, CloudMedium, NanoVdbMedium>;

// A medium of any kind at the wavelengths of a path. Every kind has
//   MediumRay RayAlong(const Ray&) const;
//     A medium ray (majorant.h) for Fly and FlyShadow. Must not outlive the coefficients, nor these the
//     medium.
//   const HomogeneousCoefficients* Homogeneous() const;
//     Null unless the medium is the same everywhere.
//   bool MayCollide() const;
//     False if no flight draws a random number.
//   float CollisionDistanceMax(float u) const;
//     An upper bound of the distance of the first collision of a flight whose first random number is u;
//     infinite if there is no bound.
using MediumCoefficients =
    std::variant<HomogeneousCoefficients, GridCoefficients, RgbGridCoefficients, CloudCoefficients>;

// A medium. Immutable.
class Medium {
 public:
  Medium() = default;  // a vacuum
  template <AlternativeOf<MediumKind> Kind>
  explicit Medium(const Kind& kind) : kind_(kind) {}

  MediumCoefficients At(const SampledWavelengths& wavelengths) const {
    return Dispatch(kind_, [&](const auto& kind) -> MediumCoefficients { return kind.At(wavelengths); });
  }
  const PhaseFunction& phase() const {
    return Dispatch(kind_, [](const auto& kind) -> const PhaseFunction& { return kind.phase(); });
  }
  bool is_emissive() const {
    return Dispatch(kind_, [](const auto& kind) { return kind.is_emissive(); });
  }

 private:
  MediumKind kind_;
};

// By the index of SceneDescription::media. Immutable.
class MediumTable {
 public:
  static Result<MediumTable> Build(const SceneDescription& scene, const Transform& render_from_world,
                                   FileSource& files, Diagnostics& diagnostics);

  const Medium& operator[](int medium) const { return media_[static_cast<size_t>(medium)]; }
  bool empty() const { return media_.empty(); }
  // Whether any of them emits light.
  bool is_emissive() const { return std::ranges::any_of(media_, &Medium::is_emissive); }
  size_t size() const { return media_.size(); }

 private:
  std::vector<Medium> media_;
};

// What scenes may ask for.
KindList MediumKinds();

}  // namespace tessera
