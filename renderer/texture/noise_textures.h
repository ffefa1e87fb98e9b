// The textures made of noise. All are solid: they depend on the point, not on uv.
#pragma once

#include "renderer/texture/noise.h"
#include "renderer/texture/patterns.h"

namespace tessera {

// pbrt's fbm; float only.
struct FractalNoiseTexture {
  int mapping = -1;
  NoiseSettings noise;

  template <typename Evaluation>
  float Evaluate(const Evaluation& e) const {
    const TextureCoordinates3 c = e.Map3(mapping);
    return FractalNoise(c.p, c.dpdx, c.dpdy, noise.roughness, noise.octaves);
  }
};

// pbrt's wrinkled; float only.
struct TurbulenceTexture {
  int mapping = -1;
  NoiseSettings noise;

  template <typename Evaluation>
  float Evaluate(const Evaluation& e) const {
    const TextureCoordinates3 c = e.Map3(mapping);
    return Turbulence(c.p, c.dpdx, c.dpdy, noise.roughness, noise.octaves);
  }
};

// Float only.
struct WindyTexture {
  int mapping = -1;

  template <typename Evaluation>
  float Evaluate(const Evaluation& e) const {
    return WindyWaves(e.Map3(mapping));
  }
};

// Spectrum only.
struct MarbleTexture {
  int mapping = -1;
  NoiseSettings noise;

  template <typename Evaluation>
  SampledSpectrum Evaluate(const Evaluation& e) const {
    return e.Albedo(MarbleColor(e.Map3(mapping), noise));
  }
};

}  // namespace tessera
