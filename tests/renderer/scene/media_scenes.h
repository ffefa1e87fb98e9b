// Small pictures of media, and what they are compared with.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera::media_scenes {

// Eight by eight pixels in the middle of the view along +z, all in nearly the same direction.
inline std::string Narrow(const std::string& rest) {
  return R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 0.5
)" + rest;
}

inline std::string Wide(const std::string& rest) {
  std::string text = Narrow(rest);
  return text.replace(text.find("0.5"), 3, "60");
}

// R, G, B of 64 pixels.
struct Pixels {
  std::vector<double> values;

  double Mean(int channel) const {
    double sum = 0;
    for (size_t i = 0; i < 64; ++i) sum += values[i * 3 + static_cast<size_t>(channel)];
    return sum / 64;
  }
};

inline Result<std::unique_ptr<Scene>> LoadMedia(const std::string& text, const RenderOptions& options = {}) {
  MemoryFiles files({{"scene.pbrt", text}});
  return Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
}

inline std::vector<float> Sums(const std::string& text, uint32_t samples, const RenderOptions& options = {}) {
  const Result<std::unique_ptr<Scene>> scene = LoadMedia(text, options);
  EXPECT_TRUE(scene.has_value()) << scene.error().message;
  if (!scene) return std::vector<float>(256);
  RenderStatistics statistics;
  std::vector<float> sums = (*scene)->Render({0, 0, 8, 8}, {}, {0, samples}, nullptr, &statistics)->sums;
  EXPECT_EQ(statistics.discarded_samples, 0u);
  return sums;
}

inline Pixels Render(const std::string& text, uint32_t samples, const RenderOptions& options = {}) {
  const std::vector<float> sums = Sums(text, samples, options);
  Pixels pixels;
  for (size_t i = 0; i < 64; ++i) {
    for (size_t c = 0; c < 3; ++c)
      pixels.values.push_back(static_cast<double>(sums[i * 4 + c] / sums[i * 4 + 3]));
  }
  return pixels;
}

// A sample draws its wavelengths first. Where the spectra of both pictures differ by a factor alone, the
// pictures have the same colour noise, and no other noise if nothing else is random.
inline void ExpectEverywhere(const Pixels& pixels, const Pixels& original, double factor, double tolerance) {
  for (size_t i = 0; i < pixels.values.size(); ++i) {
    ASSERT_NEAR(pixels.values[i] / original.values[i], factor, tolerance * factor) << i;
  }
}
inline void ExpectMean(const Pixels& pixels, const Pixels& original, double factor, double tolerance,
                       const std::string& what = "") {
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(pixels.Mean(c) / original.Mean(c), factor, tolerance * factor) << what << ", channel " << c;
  }
}

constexpr const char* kVolPath = R"(
Sampler "independent" "integer pixelsamples" 65536
Integrator "volpath" "integer maxdepth" 1000
)";

// A medium with the same coefficients at all wavelengths.
inline std::string Medium(const std::string& name, double sigma_a, double sigma_s,
                          const std::string& more = "") {
  const auto even = [](const char* what, double value) {
    return std::string(" \"spectrum ") + what + "\" [ 300 " + std::to_string(value) + " 900 " +
           std::to_string(value) + " ]";
  };
  return "MakeNamedMedium \"" + name + "\" \"string type\" \"homogeneous\"" + even("sigma_a", sigma_a) +
         even("sigma_s", sigma_s) + " " + more + "\n";
}

// A sphere around (0, 0, 4) in the surrounding medium.
inline std::string Ball(const std::string& material, const std::string& inside, double radius = 1) {
  return "AttributeBegin\nTranslate 0 0 4\nMediumInterface \"" + inside + "\" \"\"\nMaterial " + material +
         "\nShape \"sphere\" \"float radius\" " + std::to_string(radius) + "\nAttributeEnd\n";
}

constexpr const char* kEvenLight = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
constexpr const char* kDistantLight =
    "LightSource \"distant\" \"point3 from\" [ 0 0 -1 ] \"point3 to\" [ 0 0 1 ] \"rgb L\" [ 2 2 2 ]\n";

}  // namespace tessera::media_scenes
