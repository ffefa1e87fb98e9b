// Lights from scene text in memory, on shapes made by hand.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <string>
#include <vector>

#include "renderer/color/named_spectra.h"
#include "renderer/light/light.h"
#include "renderer/math/sampling.h"
#include "renderer/pbrt/parser.h"
#include "tests/chi_square.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

// A portable float map of `width` pixels per row; pixels start at the top left.
inline std::string Pfm(const std::vector<Vec3>& pixels, int width) {
  const int height = static_cast<int>(pixels.size()) / width;
  std::string bytes = "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1\n";
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) {
      const auto raw =
          std::bit_cast<std::array<char, sizeof(Vec3)>>(pixels[static_cast<size_t>(y * width + x)]);
      bytes.append(raw.begin(), raw.end());
    }
  }
  return bytes;
}

// A scene of lights. The i-th Shape directive of the text stands for shapes[i].
struct LightScene {
  MemoryFiles files;
  ImageCache images{files};
  TextureTable textures;
  SceneDescription scene;
  Geometry geometry;
  LightTable table;
  Diagnostics diagnostics;
  std::string error;  // of the table

  // The pictures must be in `files` already.
  void Build(const std::string& text, const std::vector<Shape>& shapes = {},
             LightSamplerKind light_sampler = LightSamplerKind::kTree) {
    Result<SceneDescription> parsed =
        ParseSceneText(files, "lights.pbrt", "Camera \"perspective\"\nWorldBegin\n" + text);
    ASSERT_TRUE(parsed) << parsed.error().message;
    scene = *std::move(parsed);
    geometry.shapes = shapes;
    ASSERT_EQ(scene.shapes.size(), shapes.size());
    std::vector<EmittingShape> emitters;
    for (uint32_t i = 0; i < shapes.size(); ++i) {
      if (scene.shapes[i].area_light) emitters.push_back({&scene.shapes[i], i});
    }
    const Transform identity;
    const LightInputs inputs{scene, emitters, identity, light_sampler, files, images, textures};
    Result<BuiltLights> built = LightTable::Build(inputs, geometry, diagnostics);
    if (!built) {
      error = built.error().message;
      return;
    }
    table = std::move(built->table);
    for (size_t i = 0; i < emitters.size(); ++i)
      geometry.shapes[emitters[i].shape].surface.area_light = built->area_lights[i];
  }
};

inline ReferencePoint At(Point3 p, Normal3 n = {}) {
  return {p, {}, n, n};
}

inline Shape SphereShape(Point3 center, float radius) {
  Quadric sphere;
  sphere.render_from_object = Translate(center);
  sphere.radius = radius;
  sphere.z_min = -radius;
  sphere.z_max = radius;
  Shape shape;
  shape.form = sphere;
  return shape;
}

// Faces +z at height z.
inline Shape DiskShape(float z, float radius, bool flip_normals = false) {
  Quadric disk;
  disk.kind = Quadric::Kind::kDisk;
  disk.radius = radius;
  disk.z_min = disk.z_max = z;
  disk.flip_normals = flip_normals;
  Shape shape;
  shape.form = disk;
  return shape;
}

inline Shape MeshShape(std::vector<Point3> points, std::vector<uint32_t> indices) {
  TriangleMesh mesh;
  mesh.P = std::move(points);
  mesh.indices = std::move(indices);
  Shape shape;
  shape.form = mesh;
  return shape;
}

// Four consecutive wavelengths from 360 + first nm, to look up spectra nm by nm.
inline SampledWavelengths FourWavelengths(int first) {
  alignas(16) int index[4];
  float lambda[4];
  for (int i = 0; i < 4; ++i) {
    index[i] = std::min(first + i, kLambdaCount - 1);
    lambda[i] = static_cast<float>(kLambdaMin + index[i]);
  }
  SampledWavelengths wavelengths;
  wavelengths.lambda = {lambda[0], lambda[1], lambda[2], lambda[3]};
  wavelengths.pdf = Float4(1.0f);
  wavelengths.index = _mm_load_si128(reinterpret_cast<const __m128i*>(index));
  return wavelengths;
}

// The luminance of `spectrum(wavelengths)`, in the units of the lights' parameters.
template <typename F>
float Luminance(const F& spectrum) {
  double sum = 0;
  for (int first = 0; first < kLambdaCount; first += 4) {
    const SampledSpectrum values = spectrum(FourWavelengths(first));
    for (int i = 0; i < 4 && first + i < kLambdaCount; ++i) {
      sum += static_cast<double>(values[i]) * CieY()[static_cast<size_t>(first + i)];
    }
  }
  return static_cast<float>(sum);
}

// Luminance of the sample of `light`; 0 if there is none.
inline float SampleLuminance(const LightTable& table, int light, const ReferencePoint& reference, Point2 u) {
  return Luminance([&](const SampledWavelengths& wavelengths) {
    const std::optional<LightSample> sample = table.Sample(light, reference, u, wavelengths);
    return sample ? sample->Radiance(wavelengths) : SampledSpectrum();
  });
}

// The irradiance that `light` gives, unoccluded: the mean over `count` stratified samples.
inline float Irradiance(const LightTable& table, int light, const ReferencePoint& reference,
                        int count_per_side) {
  // All samples of a light have the same spectrum, so one wavelength determines the ratio.
  const SampledWavelengths green = FourWavelengths(555 - kLambdaMin);
  TestRandom random(7);
  double sum = 0;
  float luminance = 0, at_green = 0;
  for (int y = 0; y < count_per_side; ++y) {
    for (int x = 0; x < count_per_side; ++x) {
      const Point2 jitter = random.Next2<Point2>();
      const Point2 u{(static_cast<float>(x) + jitter.x) / static_cast<float>(count_per_side),
                     (static_cast<float>(y) + jitter.y) / static_cast<float>(count_per_side)};
      const std::optional<LightSample> sample = table.Sample(light, reference, u, green);
      if (!sample) continue;
      if (at_green == 0) {
        at_green = sample->Radiance(green)[0];
        luminance = SampleLuminance(table, light, reference, u);
      }
      sum += static_cast<double>(sample->Radiance(green)[0]) * std::max(0.0f, Dot(sample->wi, reference.n)) /
             sample->pdf;
    }
  }
  if (at_green == 0) return 0;
  return static_cast<float>(sum / (count_per_side * count_per_side)) * luminance / at_green;
}

}  // namespace tessera
