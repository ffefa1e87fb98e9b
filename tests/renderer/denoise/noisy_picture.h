// Pictures with noise, made from a description of what is seen at each pixel.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

// What is at a pixel of a scene without noise.
struct Point {
  float light = 1;   // falls on it
  float albedo = 1;  // of red; green and blue have three quarters and a half of it
  float normal = 0;  // its x component
  float depth = 1;
};
using PaintPoint = std::function<Point(int x, int y)>;

// Evenly distributed from -1 to 1 by a hash of its arguments (the finaliser of MurmurHash3).
inline float Noise(int x, int y, int k) {
  uint32_t h = static_cast<uint32_t>(x) * 0x9E3779B1u ^ static_cast<uint32_t>(y) * 0x85EBCA77u ^
               static_cast<uint32_t>(k + 1) * 0xC2B2AE3Du;
  h = (h ^ (h >> 16)) * 0x85EBCA6Bu;
  h = (h ^ (h >> 13)) * 0xC2B2AE35u;
  return static_cast<float>((h ^ (h >> 16)) >> 8) / static_cast<float>(1 << 23) - 1;
}

inline const std::vector<std::string> kNoisyChannels = {
    "B",        "G",        "R",        "albedo.B", "albedo.G", "albedo.R", "depth.Z",
    "halves.B", "halves.G", "halves.R", "normal.X", "normal.Y", "normal.Z"};

inline float& Value(LoadedPicture& picture, const std::string& channel, int x, int y) {
  const auto found = std::ranges::find(picture.channels, channel);
  EXPECT_NE(found, picture.channels.end()) << channel;
  const size_t pixel = static_cast<size_t>(y * picture.bounds.width() + x);
  return picture
      .values[pixel * picture.channels.size() + static_cast<size_t>(found - picture.channels.begin())];
}

inline float Albedo(const Point& point, int c) {
  return point.albedo * (1 - 0.25f * static_cast<float>(c));
}

// The light of each half is noisy by up to this part of itself. `seed` chooses the noise.
inline LoadedPicture Rendered(int width, int height, float noise, const PaintPoint& paint, int seed = 0) {
  LoadedPicture picture;
  picture.width = width;
  picture.height = height;
  picture.bounds = {0, 0, width, height};
  picture.channels = kNoisyChannels;
  picture.values.resize(static_cast<size_t>(width * height) * kNoisyChannels.size());
  const char* const colors = "RGB";
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Point point = paint(x, y);
      for (int c = 0; c < 3; ++c) {
        const float value = point.light * Albedo(point, c);
        const float a = value * (1 + noise * Noise(x, y, c + 6 * seed));
        const float b = value * (1 + noise * Noise(x, y, c + 6 * seed + 3));
        const std::string name(1, colors[c]);
        Value(picture, name, x, y) = 0.5f * (a + b);
        Value(picture, "halves." + name, x, y) = 0.5f * (a - b);
        Value(picture, "albedo." + name, x, y) = Albedo(point, c);
      }
      Value(picture, "normal.X", x, y) = point.normal;
      Value(picture, "normal.Z", x, y) = std::sqrt(1 - point.normal * point.normal);
      Value(picture, "depth.Z", x, y) = point.depth;
    }
  }
  return picture;
}

// The mean over the pixels of ((R - truth) / truth)^2.
inline double ErrorOf(LoadedPicture picture, const PaintPoint& paint) {
  double sum = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const Point point = paint(x, y);
      const double truth = point.light * Albedo(point, 0);
      sum += std::pow((Value(picture, "R", x, y) - truth) / truth, 2);
    }
  }
  return sum / (picture.width * picture.height);
}

}  // namespace tessera
