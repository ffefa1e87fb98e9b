// What a kind of LightSource is: a type, in files of its own, that is an alternative of SourceLight
// (light_data.h) and that the table of light_builder.cpp names. It has
//
//   static Light Read(ParameterReader& reader, const LightContext& context);
//       The light as the parameters describe it. Errors are remembered by the reader.
//   std::optional<LightSample> Sample(const LightQuery& query) const;
//       Light that arrives at a point; nullopt if there is none.
//   LightProfile Profile(float scene_radius) const;
//       What the choice between lights depends on.
//
// and, if it is at infinity and rays that leave the scene hit it,
//
//   SampledSpectrum Radiance(Point3 from, Vec3 d, const SampledWavelengths& wavelengths) const;
//       Radiance that arrives at `from` against unit direction d.
//   float Pdf(Point3 from, Vec3 wi) const;
//       The density per solid angle with which Sample gives wi.
#pragma once

#include "renderer/description/parameter_reader.h"
#include "renderer/light/light.h"
#include "renderer/light/light_chooser.h"

namespace tessera {

// Where the light of a directive is, where its spectra and pictures come from and where warnings go.
struct LightContext {
  Transform render_from_light, render_from_world;
  FileSource& files;
  ImageCache& images;
  Diagnostics& diagnostics;
  // Whether light sampling must find all of the light: the surfaces that shadow rays pass stop other rays.
  bool samples_all = false;
};

// The point that a light is sampled from.
struct LightQuery {
  const ReferencePoint& reference;
  Point2 u;                // in [0, 1)
  float scene_radius = 0;  // of a sphere around all geometry
  const SampledWavelengths& wavelengths;
};

template <typename Light>
concept HitByRays = requires(const Light& light, Point3 from, Vec3 d, const SampledWavelengths& wavelengths) {
  light.Radiance(from, d, wavelengths);
  light.Pdf(from, d);
};

}  // namespace tessera
