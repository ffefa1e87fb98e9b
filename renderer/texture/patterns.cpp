#include "renderer/texture/patterns.h"

#include <array>
#include <cmath>

#include "renderer/texture/noise.h"

namespace tessera {
namespace {

// 1.5 times as wide as the footprint: a tent of that radius filters about like a box of the width of the
// footprint.
constexpr float kTentRadius = 1.5f;

// The second integral of the square wave that is +1 on [0, 1), -1 on [1, 2) and so on, up to a factor and a
// linear function, which cancel in second differences.
float SquareWaveIntegral(float x) {
  const float half = x / 2;
  const float y = half - std::floor(half) - 0.5f;
  return half + y * (1 - 2 * std::abs(y));
}

// The square wave filtered by a tent of radius r.
float FilteredSquareWave(float x, float r) {
  const float cell = std::floor(x - r);
  if (cell == std::floor(x + r)) return cell / 2 == std::floor(cell / 2) ? 1.0f : -1.0f;
  return (SquareWaveIntegral(x + r) - 2 * SquareWaveIntegral(x) + SquareWaveIntegral(x - r)) / (r * r);
}

float Wave(float x, float dx, float dy) {
  if (!std::isfinite(x)) return 0;
  const float r = kTentRadius * std::max(std::abs(dx), std::abs(dy));
  return std::isfinite(r * r) ? FilteredSquareWave(x, r) : 0;
}

float Noise2(float x, float y) {
  return Noise({x, y, 0.5f});
}

Vec3 CubicBezier(const Vec3* points, float t) {
  std::array<Vec3, 3> a;
  for (int i = 0; i < 3; ++i) a[i] = Lerp(t, points[i], points[i + 1]);
  return Lerp(t, Lerp(t, a[0], a[1]), Lerp(t, a[1], a[2]));
}

}  // namespace

float CheckerboardWeight(const TextureCoordinates2& c) {
  return 0.5f - Wave(c.st.x, c.dx.x, c.dy.x) * Wave(c.st.y, c.dx.y, c.dy.y) / 2;
}

float CheckerboardWeight(const TextureCoordinates3& c) {
  const float x = Wave(c.p.x, c.dpdx.x, c.dpdy.x);
  const float y = Wave(c.p.y, c.dpdx.y, c.dpdy.y);
  const float z = Wave(c.p.z, c.dpdx.z, c.dpdy.z);
  return 0.5f - 0.5f * x * y * z;
}

bool InsideDot(Point2 st) {
  constexpr float kRadius = 0.35f;
  constexpr float kShiftMax = 0.5f - kRadius;
  const float s_cell = std::floor(st.x + 0.5f), t_cell = std::floor(st.y + 0.5f);
  if (!(Noise2(s_cell + 0.5f, t_cell + 0.5f) > 0)) return false;
  const float s = s_cell + kShiftMax * Noise2(s_cell + 1.5f, t_cell + 2.8f);
  const float t = t_cell + kShiftMax * Noise2(s_cell + 4.5f, t_cell + 9.8f);
  return Sqr(st.x - s) + Sqr(st.y - t) < kRadius * kRadius;
}

float WindyWaves(const TextureCoordinates3& c) {
  const float strength = FractalNoise(0.1f * c.p, 0.1f * c.dpdx, 0.1f * c.dpdy, 0.5f, 3);
  return std::abs(strength) * FractalNoise(c.p, c.dpdx, c.dpdy, 0.5f, 6);
}

Vec3 MarbleColor(const TextureCoordinates3& c, const NoiseSettings& settings) {
  static constexpr std::array<Vec3, 9> kColors{{{0.58f, 0.58f, 0.6f},
                                                {0.58f, 0.58f, 0.6f},
                                                {0.58f, 0.58f, 0.6f},
                                                {0.5f, 0.5f, 0.5f},
                                                {0.6f, 0.59f, 0.58f},
                                                {0.58f, 0.58f, 0.6f},
                                                {0.58f, 0.58f, 0.6f},
                                                {0.2f, 0.2f, 0.33f},
                                                {0.58f, 0.58f, 0.6f}}};
  constexpr int kSegments = static_cast<int>(kColors.size()) - 3;
  const float scale = settings.scale;
  const Point3 p = c.p * scale;
  const float veins = p.y + settings.variation * FractalNoise(p, scale * c.dpdx, scale * c.dpdy,
                                                              settings.roughness, settings.octaves);
  const float t = std::isfinite(veins) ? (0.5f + 0.5f * std::sin(veins)) * kSegments : 0;
  const int first = std::clamp(static_cast<int>(t), 0, kSegments - 1);
  return 1.5f * CubicBezier(&kColors[first], t - static_cast<float>(first));
}

}  // namespace tessera
