// Flights of paths and of shadow rays through a medium, by null scattering in the path-integral form of B.
// Miller, I. Georgiev, W. Jarosz ("A Null-Scattering Path Integral Formulation of Light Transport", 2019), as
// Pharr, Jakob, Humphreys (2023, section 14.2) extend it to four wavelengths: the first wavelength decides,
// and multiple importance sampling weights the path by the densities that each wavelength would have had.
//
// Where a stretch is uniform, absorption, emission and the transmittance of shadow rays are computed in
// closed form.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "renderer/math/random_stream.h"
#include "renderer/math/ray.h"
#include "renderer/math/sampling.h"
#include "renderer/medium/majorant.h"

namespace tessera {

// What a path carries. Densities are relative to that of the path as it was sampled.
struct PathWeights {
  SampledSpectrum beta{1.0f};  // contribution over density
  SampledSpectrum r_u{1.0f};   // density if this wavelength had decided (unidirectional)
  SampledSpectrum r_l{1.0f};   // density if it had and light sampling had led to the end of the current ray

  // The contribution, weighted between the wavelengths by the balance heuristic.
  SampledSpectrum Throughput() const { return beta / Average(r_u); }
};

// The random numbers of one flight. The first is passed in, as that of a sampler is well distributed; for
// flights of many collisions an independent stream follows, which is a function of the ray.
class FlightRandom {
 public:
  FlightRandom(const Ray& ray, float first) : ray_(ray), first_(first) {}
  // All numbers are functions of the ray.
  explicit FlightRandom(const Ray& ray) : ray_(ray), count_(1) {}

  // In [0, 1).
  float Next() {
    if (count_ == 0) {
      ++count_;
      return first_;
    }
    if (count_ == 1) seed_ = ExtendHash(Hash(ray_.o, ray_.d), std::bit_cast<uint32_t>(first_));
    ++count_;
    return UniformFloatFromHash(Hash(seed_, count_));
  }

 private:
  const Ray& ray_;
  float first_ = 0;
  uint64_t seed_ = 0;
  uint32_t count_ = 0;
};

// The integral of exp(-sigma s) over s in [0, t].
inline SampledSpectrum IntegralOfExp(SampledSpectrum sigma, float t) {
  alignas(16) float s[4];
  _mm_store_ps(s, sigma.v);
  for (float& value : s) {
    const float depth = value * t;
    // The difference from 1 would cancel for a small depth, which uses the series instead.
    value = depth < 0.01f ? t * (1 - depth * (0.5f - depth * (1.0f / 6))) : (1 - std::exp(-depth)) / value;
  }
  return _mm_load_ps(s);
}

// The longest flight, in scene units. It is longer than any scene, and paths of a million flights still stay
// within the range of coordinates that Embree traces (below 1.8e18).
constexpr float kFlightMax = 1e12f;

// How a flight ended.
enum class FlightEnd {
  kPassed,     // at t_max
  kScattered,  // at *t_event
  kAbsorbed,
};

namespace flight {

// Extends the weights over a length without a collision that stays in one uniform stretch.
inline void Pass(const MajorantSegment& segment, float length, PathWeights* weights) {
  const SampledSpectrum attenuation = Exp((segment.sigma_a + segment.sigma_maj) * -length);
  if (!AnyNonZero(segment.sigma_maj)) {
    weights->beta *= attenuation;
    return;
  }
  const SampledSpectrum none = Exp(segment.sigma_maj * -length);  // the probability of no collision
  const float inverse_pdf = 1 / none[0];
  weights->beta *= attenuation * inverse_pdf;
  weights->r_u *= none * inverse_pdf;
  weights->r_l *= inverse_pdf;
}

// The same in a stretch that varies, where light sampling follows the same bounds. All weights change by the
// probability of no collision relative to that of the first wavelength, which is 1 for a grey bound.
inline void PassVarying(const MajorantSegment& segment, float length, PathWeights* weights) {
  const SampledSpectrum excess = SampledSpectrum(segment.sigma_maj[0]) - segment.sigma_maj;
  if (AnyNonZero(excess)) {
    const SampledSpectrum ratio = Exp(excess * length);
    weights->beta *= ratio;
    weights->r_u *= ratio;
    weights->r_l *= ratio;
  }
  if (AnyNonZero(segment.sigma_a)) weights->beta *= Exp(segment.sigma_a * -length);
}

// The optical depth to the next collision at the first wavelength. It is drawn once and used up stretch by
// stretch, as an exponential distribution has no memory.
class CollisionDepth {
 public:
  explicit CollisionDepth(FlightRandom& random) : random_(random) {}

  // Moves over `length` with the given majorant. Returns the distance of a collision, or `length` if there is
  // none.
  float Advance(float majorant, float length) {
    if (rest_ < 0) rest_ = SampleExponential(random_.Next(), 1);
    const float depth = majorant * length;
    if (!(rest_ < depth)) {
      rest_ -= depth;
      return length;
    }
    const float distance = std::min(rest_ / majorant, length);
    rest_ = -1;
    return distance;
  }
  // Whether the last call found a collision.
  bool Collided() const { return rest_ < 0; }

 private:
  FlightRandom& random_;
  float rest_ = -1;  // negative: not drawn
};

// Extends the weights by a collision of the kind whose coefficient is `sigma`.
inline void Collide(SampledSpectrum sigma, SampledSpectrum sigma_maj, PathWeights* weights) {
  const float inverse_pdf = 1 / sigma[0];
  weights->beta *= sigma * inverse_pdf;
  weights->r_u *= sigma * inverse_pdf;
  weights->r_l *= sigma_maj * inverse_pdf;
}

// A collision in a stretch that is not uniform; kPassed if it was null.
inline FlightEnd Decide(const MajorantSegment& segment, const MediumPoint& point, float u,
                        PathWeights* weights) {
  const float place = u * segment.sigma_maj[0];
  if (place < point.sigma_s[0]) {
    Collide(point.sigma_s, segment.sigma_maj, weights);
    return FlightEnd::kScattered;
  }
  const SampledSpectrum sigma_n =
      Max(segment.sigma_maj - point.sigma_a - point.sigma_s, SampledSpectrum(0.0f));
  if (place < point.sigma_s[0] + point.sigma_a[0] || !(sigma_n[0] > 0)) return FlightEnd::kAbsorbed;
  Collide(sigma_n, segment.sigma_maj, weights);
  return FlightEnd::kPassed;
}

// The part of a flight within one uniform stretch, from *t to `end`.
inline FlightEnd FlyThroughUniform(const MajorantSegment& segment, float end, FlightRandom& random, float* t,
                                   PathWeights* weights) {
  const float majorant = segment.sigma_maj[0];
  const float step =
      majorant > 0 ? SampleExponential(random.Next(), majorant) : std::numeric_limits<float>::infinity();
  if (!(*t + step < end)) {
    Pass(segment, end - *t, weights);
    return FlightEnd::kPassed;
  }
  *t += step;
  Pass(segment, step, weights);
  Collide(segment.sigma_maj, segment.sigma_maj, weights);
  return FlightEnd::kScattered;
}

// The same within a stretch that varies. A function of its own, like TrackRatio, so that callers stay fast in
// uniform media.
template <typename MediumRay>
[[gnu::noinline]] FlightEnd FlyThroughVarying(const MediumRay& medium, const MajorantSegment& segment,
                                              float end, CollisionDepth& depth, FlightRandom& random,
                                              float* t, PathWeights* weights, SampledSpectrum* emitted) {
  float rest = end - *t;  // shrinks by steps that would be lost in a large t
  for (;;) {
    const float step = depth.Advance(segment.sigma_maj[0], rest);
    PassVarying(segment, step, weights);
    if (!depth.Collided()) return FlightEnd::kPassed;
    rest -= step;
    *t = end - rest;
    const MediumPoint point = medium.At(*t);
    if (emitted != nullptr && AnyNonZero(point.emission)) {
      *emitted += weights->beta * point.emission / Average(weights->r_u * segment.sigma_maj);
    }
    const FlightEnd end_here = Decide(segment, point, random.Next(), weights);
    if (end_here != FlightEnd::kPassed) return end_here;
  }
}

// Ratio tracking from t to `end`: every collision is null and reduces the transmittance. Russian roulette
// ends rays with little of it left.
template <typename MediumRay>
[[gnu::noinline]] void TrackRatio(const MediumRay& medium, const MajorantSegment& segment, float t, float end,
                                  CollisionDepth& depth, FlightRandom& random, PathWeights* weights) {
  constexpr float kLittle = 0.05f, kEndProbability = 0.75f;
  const float majorant = segment.sigma_maj[0];
  float rest = end - t;
  for (;;) {
    const float step = depth.Advance(majorant, rest);
    PassVarying(segment, step, weights);
    if (!depth.Collided()) return;
    rest -= step;
    const MediumPoint point = medium.At(end - rest);
    const SampledSpectrum sigma_n =
        Max(segment.sigma_maj - point.sigma_a - point.sigma_s, SampledSpectrum(0.0f)) * (1 / majorant);
    weights->beta *= sigma_n;
    weights->r_u *= sigma_n;
    weights->r_l *= segment.sigma_maj * (1 / majorant);
    if (MaxElement(weights->beta) < kLittle * Average(weights->r_l + weights->r_u)) {
      if (random.Next() < kEndProbability)
        weights->beta = SampledSpectrum(0.0f);
      else
        weights->beta /= 1 - kEndProbability;
    }
    if (!AnyNonZero(weights->beta)) return;
  }
}

}  // namespace flight

// Flies from t = 0 until something happens or t_max, which may be infinite, or kFlightMax is reached. Updates
// the weights, and adds to *emitted, unless it is null, what the medium emits towards the start of the ray.
// Sets *t_event if scattered.
template <typename MediumRay>
FlightEnd Fly(MediumRay medium, float t_max, FlightRandom& random, PathWeights* weights,
              SampledSpectrum* emitted, float* t_event) {
  float t = 0;
  t_max = std::min(t_max, kFlightMax);
  flight::CollisionDepth depth(random);
  MajorantSegment segment;
  while (t < t_max && medium.Next(&segment)) {
    const float end = std::min(segment.t_end, t_max);
    if (emitted != nullptr && AnyNonZero(segment.emission)) {
      *emitted += weights->Throughput() * segment.emission *
                  IntegralOfExp(segment.sigma_a + segment.sigma_maj, end - t);
    }
    const FlightEnd flight_end =
        segment.uniform
            ? flight::FlyThroughUniform(segment, end, random, &t, weights)
            : flight::FlyThroughVarying(medium, segment, end, depth, random, &t, weights, emitted);
    *t_event = t;
    if (flight_end != FlightEnd::kPassed) return flight_end;
    t = end;
  }
  return FlightEnd::kPassed;
}

// Follows a shadow ray over `length`. In its weights beta is the transmittance, r_u the density of a path
// that passes the same way and r_l that of this estimate, if the wavelength had decided; all relative to the
// density with which light sampling chose the ray. Closed forms where the medium is uniform, elsewhere ratio
// tracking (J. Novak, A. Selle, W. Jarosz, "Residual Ratio Tracking for Estimating Attenuation in
// Participating Media", 2014).
template <typename MediumRay>
void FlyShadow(MediumRay medium, float length, FlightRandom& random, PathWeights* weights) {
  float t = 0;
  flight::CollisionDepth depth(random);
  MajorantSegment segment;
  while (t < length && medium.Next(&segment)) {
    const float end = std::min(segment.t_end, length);
    if (segment.uniform) {
      weights->beta *= Exp((segment.sigma_a + segment.sigma_maj) * (t - end));
      if (AnyNonZero(segment.sigma_maj)) weights->r_u *= Exp(segment.sigma_maj * (t - end));
    } else {
      flight::TrackRatio(medium, segment, t, end, depth, random, weights);
      if (!AnyNonZero(weights->beta)) return;
    }
    t = end;
  }
}

}  // namespace tessera
