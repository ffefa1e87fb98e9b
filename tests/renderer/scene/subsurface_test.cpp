// Light that is scattered below surfaces, in closed form and against the parameters of the material.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera::subsurface_scenes {
namespace {

struct Mean {
  double rgb[3] = {};
  double error[3] = {};  // standard
};

// The mean colour of a narrow view along +z onto the origin.
Mean View(const std::string& world, const std::string& integrator = "volpath", uint32_t samples = 4096) {
  const std::string head = R"(
    Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false
    PixelFilter "box"
    LookAt 0 0 -5  0 0 0  0 1 0
    Camera "perspective" "float fov" 2
    Sampler "independent" "integer pixelsamples" 4096
    Integrator ")" + integrator +
                           R"(" "integer maxdepth" 8
    WorldBegin
    )";
  MemoryFiles files({{"scene.pbrt", head + world}});
  const Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kRender);
  EXPECT_TRUE(scene) << scene.error().message;
  Mean mean;
  if (!scene) return mean;
  constexpr int kBatches = 16, kPixels = 16;
  double squares[3] = {};
  RenderStatistics statistics;
  const uint32_t per_batch = samples / kBatches;
  for (uint32_t batch = 0; batch < kBatches; ++batch) {
    const RadianceTile tile =
        *(*scene)->Render({0, 0, 4, 4}, {}, {batch * per_batch, per_batch}, nullptr, &statistics);
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (int i = 0; i < kPixels; ++i) sum += tile.sums[static_cast<size_t>(i * 4 + c)];
      const double value = sum / (per_batch * kPixels);
      mean.rgb[c] += value / kBatches;
      squares[c] += value * value / kBatches;
    }
  }
  EXPECT_EQ(statistics.discarded_samples, 0u);
  for (int c = 0; c < 3; ++c)
    mean.error[c] = std::sqrt(std::max(0.0, squares[c] - mean.rgb[c] * mean.rgb[c]) / (kBatches - 1));
  return mean;
}

constexpr const char* kPlane = R"(
  Shape "trianglemesh" "point3 P" [ -50 -50 0  -50 50 0  50 50 0  50 -50 0 ] "integer indices" [ 0 1 2 0 2 3 ] )";

// What a smooth interface reflects at normal incidence.
double NormalReflectance(double eta) {
  return (eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1));
}

// Under uniform light a plane shows what the interface reflects, and of the rest its reflectance, however far
// the light of each wavelength travels.
TEST(Subsurface, PlaneUnderUniformLightHasItsReflectance) {
  const Mean mean = View(std::string(R"(
    LightSource "infinite" "rgb L" [ 1 1 1 ]
    Material "subsurface" "rgb reflectance" [ 0.8 0.5 0.2 ] "rgb mfp" [ 0.3 0.1 0.03 ] )") +
                         kPlane);
  const double reflected = NormalReflectance(1.33);
  const double expected[] = {0.8, 0.5, 0.2};
  for (int c = 0; c < 3; ++c) {
    const double value = reflected + (1 - reflected) * expected[c];
    EXPECT_NEAR(mean.rgb[c], value, 6 * mean.error[c] + 0.015 * value) << c;
    EXPECT_LT(mean.error[c], 0.02) << c;
  }
}

TEST(Subsurface, CoefficientsAndScaleGiveTheSameAsTheirReflectance) {
  const std::string light = R"(LightSource "infinite" "rgb L" [ 1 1 1 ] )";
  const auto plane = [&](const std::string& parameters) {
    return View(light + "Material \"subsurface\" " + parameters + kPlane);
  };
  const Mean coarse = plane(R"("rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 9 9 9 ])");
  const Mean fine = plane(R"("rgb sigma_a" [ .1 .1 .1 ] "rgb sigma_s" [ .9 .9 .9 ] "float scale" 50)");
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(coarse.rgb[c], fine.rgb[c], 6 * (coarse.error[c] + fine.error[c]) + 1e-3) << c;
}

// A small bright patch far from where the camera looks lights it through the material alone, more so the
// longer the mean free path.
TEST(Subsurface, LightTravelsBelowTheSurfaceAsFarAsItsMeanFreePath) {
  const auto seen_at_a_distance = [&](const char* mfp) {
    // A lamp just above the surface, 0.5 away, whose light reaches the origin only from below.
    return View(
               std::string(
                   R"(Material "subsurface" "rgb reflectance" [ 0.9 0.9 0.9 ] "float roughness" 0 "rgb mfp" )") +
               mfp + kPlane + R"(
      Material "diffuse" "rgb reflectance" [ 0 0 0 ]
      AttributeBegin AreaLightSource "diffuse" "rgb L" [ 500 500 500 ]
      Translate 0.5 0 -0.01 Shape "disk" "float radius" 0.1 AttributeEnd)")
        .rgb[1];
  };
  const double near = seen_at_a_distance("[ 0.003 0.003 0.003 ]"),
               far = seen_at_a_distance("[ 0.3 0.3 0.3 ]");
  EXPECT_GT(far, 0.1);
  EXPECT_GT(far, 20 * near);
}

TEST(Subsurface, IsClearGlassForOtherIntegratorsWithAWarning) {
  MemoryFiles files({{"scene.pbrt", std::string(R"(
    Camera "perspective"
    Integrator "path"
    WorldBegin
    Material "subsurface")") + kPlane}});
  const Result<std::unique_ptr<Scene>> scene = Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kRender);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT((*scene)->summary().warnings,
              testing::Contains(
                  "scene.pbrt:3:5: \"subsurface\" materials are clear glass for integrator \"path\", as "
                  "in pbrt; \"volpath\" scatters light in them"));
}

TEST(Subsurface, ScattersWhereAMixChoosesIt) {
  const std::string light = R"(LightSource "infinite" "rgb L" [ 1 1 1 ] )";
  const Mean mean = View(light + R"(
    MakeNamedMaterial "skin" "string type" "subsurface" "rgb reflectance" [ 0.6 0.6 0.6 ] "rgb mfp" [ .1 .1 .1 ]
    MakeNamedMaterial "black" "string type" "diffuse" "rgb reflectance" [ 0 0 0 ]
    Material "mix" "string materials" [ "skin" "black" ] "float amount" 0.5)" +
                         kPlane);
  const double reflected = NormalReflectance(1.33);
  EXPECT_NEAR(mean.rgb[1], 0.5 * (reflected + (1 - reflected) * 0.6), 6 * mean.error[1] + 0.01);
}

}  // namespace
}  // namespace tessera::subsurface_scenes
