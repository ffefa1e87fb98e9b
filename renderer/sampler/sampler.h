// Random numbers for one sample of one pixel. Every value is a function of (settings, pixel, sample index,
// dimension) alone, so that any sample can be drawn anywhere, in any order.
//
// To add a kind of sampler, write a class that satisfies SamplerKind in files of its own, append it to
// Sampler's variant and give it a row in sampler_settings.cpp.
#pragma once

#include <concepts>
#include <cstdint>
#include <variant>

#include "renderer/math/vec.h"
#include "renderer/sampler/halton_sampler.h"
#include "renderer/sampler/independent_sampler.h"
#include "renderer/sampler/padded_sobol_sampler.h"
#include "renderer/sampler/pmj02bn_sampler.h"
#include "renderer/sampler/sobol_sampler.h"
#include "renderer/sampler/stratified_sampler.h"
#include "renderer/sampler/zsobol_sampler.h"
#include "renderer/util/dispatch.h"

namespace tessera {

template <typename T>
concept SamplerKind = requires(T& sampler, SamplerDirective& directive, int x, int y, uint32_t index) {
  // Whether the first samples of a pixel change with the number of samples.
  { T::kDependsOnCount } -> std::convertible_to<bool>;
  // Reports errors to the reader.
  { T::Read(directive) } -> std::same_as<T>;
  // See Sampler.
  { sampler.StartSample(x, y, index) } -> std::same_as<void>;
  { sampler.Get1D() } -> std::same_as<float>;
  { sampler.Get2D() } -> std::same_as<Point2>;
};

template <SamplerKind... Kinds>
using SamplerOf = std::variant<Kinds...>;
using AnySampler = SamplerOf<IndependentSampler, StratifiedSampler, SobolSampler, PaddedSobolSampler,
                             ZSobolSampler, HaltonSampler, Pmj02bnSampler>;

// What chooses a light and a place on it, and a lobe and a direction.
struct VertexNumbers {
  float u_choice = 0;
  Point2 u_light;
  float u_lobe = 0;
  Point2 u_direction;
};

// One per render thread; a small value.
class Sampler {
 public:
  Sampler() = default;
  Sampler(const AlternativeOf<AnySampler> auto& kind) : kind_(kind) {}

  // Starts sample `index` of pixel (x, y) at dimension 0.
  void StartSample(int x, int y, uint32_t index) {
    Dispatch(kind_, [=](auto& kind) { kind.StartSample(x, y, index); });
  }
  // The next dimension, in [0, 1).
  float Get1D() {
    return Dispatch(kind_, [](auto& kind) { return kind.Get1D(); });
  }
  // The next two dimensions together, in [0, 1)^2.
  Point2 Get2D() {
    return Dispatch(kind_, [](auto& kind) { return kind.Get2D(); });
  }

  // What a vertex takes: Get1D, Get2D, Get1D and Get2D.
  VertexNumbers GetVertex() {
    return Dispatch(kind_, [](auto& kind) {
      VertexNumbers numbers;
      numbers.u_choice = kind.Get1D();
      numbers.u_light = kind.Get2D();
      numbers.u_lobe = kind.Get1D();
      numbers.u_direction = kind.Get2D();
      return numbers;
    });
  }

  // Whether the first samples of a pixel change with the number of samples.
  bool DependsOnCount() const {
    return Dispatch(kind_, [](const auto& kind) { return std::decay_t<decltype(kind)>::kDependsOnCount; });
  }

 private:
  AnySampler kind_;
};

}  // namespace tessera
