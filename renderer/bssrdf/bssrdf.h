// How light that enters a surface at one point leaves it around another: a separable BSSRDF with a tabulated
// radial profile (Christensen and Burley 2015 for the three probing axes; pbrt-v4's TabulatedBSSRDF).
#pragma once

#include <array>
#include <optional>

#include "renderer/bssrdf/diffusion_profile.h"
#include "renderer/color/sampled_spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

// Where to look for the point at which light enters: hits of the surface along this segment.
struct ProbeSegment {
  Point3 from;
  Vec3 along;  // its length is that of the segment
};

// The spatial part at one point po where light leaves. A plain value; the profile must outlive it.
class Bssrdf {
 public:
  // ns: the shading normal at po. sigma_a, sigma_s: per unit of length in rendering space.
  Bssrdf(const DiffusionProfile& profile, Point3 po, Normal3 ns, SampledSpectrum sigma_a,
         SampledSpectrum sigma_s);

  // Returns nullopt if nothing is scattered at the first wavelength, or too far away.
  std::optional<ProbeSegment> SampleProbe(float u_axis, Point2 u) const;
  // Light that enters at p and leaves at po, per area, without the directional factors.
  SampledSpectrum Evaluate(Point3 p) const { return EvaluateRadius(Distance(po_, p)); }
  // The density per area of the surface with which a probe of each wavelength meets p, where the normal is n.
  SampledSpectrum Pdf(Point3 p, Normal3 n) const;

 private:
  SampledSpectrum EvaluateRadius(float radius) const;

  const DiffusionProfile* profile_;
  Point3 po_;
  Frame frame_;
  std::array<DiffusionProfile::AlbedoPlace, 4> albedo_;  // of each wavelength
  SampledSpectrum sigma_t_, effective_;
  float radius_max_ = 0;  // of probes: nearly all light enters within it
};

}  // namespace tessera
