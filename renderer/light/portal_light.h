// Light from all around, infinitely far away, that comes in through a rectangle (Bitterli, Novak, Jarosz
// 2015, "Portal-Masked Environment Map Sampling"; Pharr, Jakob, Humphreys 2023, section 12.5.3).
#pragma once

#include <array>
#include <optional>

#include "renderer/light/emission_image.h"
#include "renderer/light/light_kind.h"
#include "renderer/math/bounds.h"
#include "renderer/math/windowed_distribution.h"

namespace tessera {

// As in pbrt the picture is resampled once into the frame of the portal, with the angles in its two planes as
// coordinates: the rectangle is a rectangle there, as seen from any point. Each texel is constant. Only
// directions through the portal bring light, whatever else is open.
struct PortalInfiniteLight {
  Frame frame;                          // x and y along the sides of the portal, z towards the sky
  Point3 corner, opposite;              // of the rectangle, in render space
  Bounds3 box;                          // around it
  EmissionMap map;                      // in the frame of the portal
  WindowedDistribution2D distribution;  // radiance times the solid angle of a texel
  float mean_strength = 0;              // of the radiance, over the hemisphere before the portal
  float area = 0;

  // Expects parameter `portal`, and `filename` or `L`.
  static PortalInfiniteLight Read(ParameterReader& reader, const LightContext& context);
  SampledSpectrum Radiance(Point3 from, Vec3 d, const SampledWavelengths& wavelengths) const;
  std::optional<LightSample> Sample(const LightQuery& query) const;
  float Pdf(Point3 from, Vec3 wi) const;
  LightProfile Profile(float scene_radius) const;

 private:
  using Window = WindowedDistribution2D::Window;

  // Sets the frame and the corners.
  void ReadPortal(ParameterReader& reader, const LightContext& context);
  // The direction of a place in the map. Sets the solid angle per area of the map.
  Vec3 DirectionAt(Point2 uv, float* solid_angle) const;
  // Returns nullopt for directions that lead away from the sky.
  std::optional<Point2> PlaceInMap(Vec3 d, float* solid_angle) const;
  // The part of the map that is seen from p. Returns nullopt on the other side of the portal.
  std::optional<Window> WindowFrom(Point3 p) const;
};

}  // namespace tessera
