#include "renderer/texture/noise.h"

#include <algorithm>
#include <cmath>

#include "renderer/texture/noise_data.h"

namespace tessera {
namespace {

constexpr float kNoisePeriod = 1 << 30;  // keeps cells within 32 bits
constexpr float kLacunarity = 1.99f;     // not 2, so that the zeros of the octaves do not coincide
constexpr float kMeanAbsoluteNoise = 0.2f;

// The dot product of the gradient of cell corner (x, y, z) with the offset from it.
float Gradient(int x, int y, int z, Vec3 offset) {
  const auto& table = kNoisePermutation;
  const int hash = table[(table[(table[x & 255] + y) & 255] + z) & 255] & 15;
  const float u = hash < 8 || hash == 12 || hash == 13 ? offset.x : offset.y;
  const float v = hash < 4 || hash == 12 || hash == 13 ? offset.y : offset.z;
  return (hash & 1 ? -u : u) + (hash & 2 ? -v : v);
}

float Smooth(float t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

float SmoothStep(float x, float a, float b) {
  const float t = std::clamp((x - a) / (b - a), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// The number of octaves that are visible under the footprint; the fraction is the weight of the last one.
float VisibleOctaves(Vec3 dpdx, Vec3 dpdy, int octaves) {
  const float length_squared = std::max(LengthSquared(dpdx), LengthSquared(dpdy));
  const float visible = -1 - std::log2(length_squared) / 2;
  return std::isnan(visible) ? 0 : std::clamp(visible, 0.0f, static_cast<float>(octaves));
}

}  // namespace

float Noise(Point3 p) {
  if (!IsFinite(p)) return 0;
  p = {std::fmod(p.x, kNoisePeriod), std::fmod(p.y, kNoisePeriod), std::fmod(p.z, kNoisePeriod)};
  const int x = static_cast<int>(std::floor(p.x));
  const int y = static_cast<int>(std::floor(p.y));
  const int z = static_cast<int>(std::floor(p.z));
  const Vec3 d{p.x - static_cast<float>(x), p.y - static_cast<float>(y), p.z - static_cast<float>(z)};
  const Vec3 w{Smooth(d.x), Smooth(d.y), Smooth(d.z)};
  float layer[2];
  for (int k = 0; k < 2; ++k) {
    float line[2];
    for (int j = 0; j < 2; ++j) {
      const float dy = d.y - static_cast<float>(j), dz = d.z - static_cast<float>(k);
      line[j] = Lerp(w.x, Gradient(x, y + j, z + k, {d.x, dy, dz}),
                     Gradient(x + 1, y + j, z + k, {d.x - 1, dy, dz}));
    }
    layer[k] = Lerp(w.y, line[0], line[1]);
  }
  return Lerp(w.z, layer[0], layer[1]);
}

float FractalNoise(Point3 p, Vec3 dpdx, Vec3 dpdy, float roughness, int octaves) {
  const float visible = VisibleOctaves(dpdx, dpdy, octaves);
  const int whole = static_cast<int>(visible);
  float sum = 0, frequency = 1, weight = 1;
  for (int i = 0; i < whole; ++i) {
    sum += weight * Noise(frequency * p);
    frequency *= kLacunarity;
    weight *= roughness;
  }
  return sum + weight * SmoothStep(visible - static_cast<float>(whole), 0.3f, 0.7f) * Noise(frequency * p);
}

float Turbulence(Point3 p, Vec3 dpdx, Vec3 dpdy, float roughness, int octaves) {
  const float visible = VisibleOctaves(dpdx, dpdy, octaves);
  const int whole = static_cast<int>(visible);
  float sum = 0, frequency = 1, weight = 1;
  for (int i = 0; i < whole; ++i) {
    sum += weight * std::abs(Noise(frequency * p));
    frequency *= kLacunarity;
    weight *= roughness;
  }
  const float fade = SmoothStep(visible - static_cast<float>(whole), 0.3f, 0.7f);
  sum += weight * Lerp(fade, kMeanAbsoluteNoise, std::abs(Noise(frequency * p)));
  for (int i = whole; i < octaves; ++i) {
    sum += weight * kMeanAbsoluteNoise;
    weight *= roughness;
  }
  return sum;
}

}  // namespace tessera
