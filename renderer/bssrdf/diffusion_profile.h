// How far light travels below the surface of a half-space that scatters it: photon beam diffusion (Habel,
// Christensen, Jarosz 2013) with the classical dipole's boundary, tabulated over albedo and radius as in
// pbrt-v4 (Pharr, Jakob, Humphreys 2016, section 15.5).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/bssrdf/catmull_rom.h"

namespace tessera {

// Radii are in mean free paths. Immutable; thread safe.
class DiffusionProfile {
 public:
  static constexpr int kAlbedos = 100, kRadii = 64;

  // g: asymmetry of the phase function; eta: index of refraction below over above.
  DiffusionProfile(float g, float eta);

  uint64_t bytes() const { return sizeof(*this) + (profile_.size() + before_.size()) * sizeof(float); }

  // Where an albedo lies in the table; found once for all radii.
  using AlbedoPlace = SplineWeights;
  // albedo: of one scattering event.
  AlbedoPlace PlaceOf(float albedo) const;

  // Light that leaves at this radius, per area; 0 beyond the table.
  float Evaluate(const AlbedoPlace& albedo, float radius) const;
  // The integral of Evaluate over the plane: the albedo that the surface seems to have.
  float EffectiveAlbedo(const AlbedoPlace& albedo) const;
  // The albedo of one event for which EffectiveAlbedo is `effective`.
  float AlbedoOf(float effective) const;
  // A radius with density Evaluate / EffectiveAlbedo per area of the plane. Returns nullopt if nothing
  // leaves.
  std::optional<float> SampleRadius(const AlbedoPlace& albedo, float u) const;

 private:
  // An entry of `table` for an albedo between those of the table.
  static float Blend(const std::vector<float>& table, const AlbedoPlace& albedo, int radius_index);

  std::array<float, kAlbedos> albedos_, effective_;
  std::array<float, kRadii> radii_;
  // The profile times the circumference, and its integral up to each radius; albedo after albedo.
  std::vector<float> profile_, before_;
};

}  // namespace tessera
