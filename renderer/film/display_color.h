// From linear radiance to the colours of 8-bit pictures. Pure functions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tessera {

using LinearRgb = std::array<float, 3>;

// Khronos PBR Neutral tone mapper (Khronos Group, 2024), without its Fresnel compensation of dark colours: it
// keeps hue and, below `start`, every value, and lets highlights fade to white.
inline LinearRgb ToneMap(LinearRgb color) {
  constexpr float kStart = 0.8f;
  constexpr float kDesaturation = 0.15f;
  for (float& value : color) value = std::isfinite(value) ? std::max(value, 0.0f) : 0.0f;
  const float peak = std::max({color[0], color[1], color[2]});
  if (peak < kStart) return color;
  constexpr float kRoom = 1 - kStart;
  const float new_peak = 1 - kRoom * kRoom / (peak + kRoom - kStart);
  const float fade = 1 - 1 / (kDesaturation * (peak - new_peak) + 1);
  for (float& value : color) value = std::lerp(value * (new_peak / peak), new_peak, fade);
  return color;
}

// IEC 61966-2-1.
inline uint8_t EncodeSrgb(float linear) {
  const float encoded = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<uint8_t>(std::lround(std::clamp(encoded, 0.0f, 1.0f) * 255));
}

}  // namespace tessera
