// Layers that guide denoisers: what is seen in mirrors and through clear glass.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/renderer/scene/layer_scenes.h"

namespace tessera {
namespace {

const std::set<std::string> kGuides{"albedo", "normal", "denoising_albedo", "denoising_normal"};

// Looks along +z at a pane, which may be turned about y, and at a wall after it. Another wall is at z = -4.
std::string PaneBefore(const std::string& pane, const std::string& front, const std::string& back,
                       const std::string& integrator = "path") {
  return "Integrator \"" + integrator + R"("
LookAt 0 0 0  0 0 1  0 1 0
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 10
Sampler "independent"
WorldBegin
LightSource "infinite"
AttributeBegin )" +
         pane +
         R"( Shape "bilinearmesh" "point3 P" [ -2 -2 2  2 -2 2  -2 2 2  2 2 2 ]
AttributeEnd
AttributeBegin )" +
         front + R"( Shape "bilinearmesh" "point3 P" [ -9 -9 4  9 -9 4  -9 9 4  9 9 4 ]
AttributeEnd
AttributeBegin )" +
         back + R"( Shape "bilinearmesh" "point3 P" [ -9 -9 -4  9 -9 -4  -9 9 -4  9 9 -4 ]
AttributeEnd
)";
}

constexpr const char* kPaint = "Material \"diffuse\" \"rgb reflectance\" [ 0.6 0.4 0.2 ]";
constexpr const char* kOtherPaint = "Material \"diffuse\" \"rgb reflectance\" [ 0.2 0.7 0.5 ]";
// Which reflects nothing.
constexpr const char* kAir = "Rotate 20 0 1 0 Material \"thindielectric\" \"float eta\" 1.0000001";

using Three = std::array<float, 3>;

Three AlbedoOf(const Scene& scene, const RadianceTile& tile, const std::string& layer) {
  return {Mean(scene, tile, layer + ".R"), Mean(scene, tile, layer + ".G"), Mean(scene, tile, layer + ".B")};
}
Three NormalOf(const Scene& scene, const RadianceTile& tile, const std::string& layer) {
  return {Mean(scene, tile, layer + ".X"), Mean(scene, tile, layer + ".Y"), Mean(scene, tile, layer + ".Z")};
}

void ExpectNear(const Three& actual, const Three& expected, float tolerance, const std::string& what) {
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << what << " " << i;
}

TEST(MirroredLayers, AreThoseOfTheSurfaceThatIsSeenThroughGlass) {
  for (const char* integrator : {"path", "volpath", "simplepath", "simplevolpath", "randomwalk"}) {
    const auto scene = LoadWith(PaneBefore(kAir, kPaint, kOtherPaint, integrator), kGuides);
    const RadianceTile tile = Rendered(*scene);
    if (std::string(integrator) != "randomwalk")
      ExpectNear(AlbedoOf(*scene, tile, "denoising_albedo"), {0.6f, 0.4f, 0.2f}, 0.03f, integrator);
    ExpectNear(AlbedoOf(*scene, tile, "albedo"), {1, 1, 1}, 0.03f, integrator);
    ExpectNear(NormalOf(*scene, tile, "normal"), {-0.342f, 0, -0.940f}, 0.01f, integrator);
  }
}

TEST(MirroredLayers, AreThoseOfTheSurfaceThatAMirrorShowsTimesWhatItReflects) {
  const char* const mirror =
      "Material \"conductor\" \"rgb reflectance\" [ 0.5 0.5 0.5 ] \"float roughness\" 0";
  for (const char* integrator : {"path", "volpath", "simplepath"}) {
    const auto scene = LoadWith(PaneBefore(mirror, kPaint, kOtherPaint, integrator), kGuides);
    const RadianceTile tile = Rendered(*scene);
    ExpectNear(AlbedoOf(*scene, tile, "denoising_albedo"), {0.1f, 0.35f, 0.25f}, 0.03f, integrator);
    ExpectNear(NormalOf(*scene, tile, "denoising_normal"), {0, 0, 1}, 1e-4f, integrator);
    ExpectNear(NormalOf(*scene, tile, "normal"), {0, 0, -1}, 1e-4f, integrator);
  }
}

// A smooth coat over paint is specular in part only.
TEST(MirroredLayers, AreThoseOfTheFirstSurfaceIfItIsNotPerfectlySpecular) {
  const std::string rough = "Material \"conductor\" \"float roughness\" 0.3";
  const std::string coat =
      "Material \"coateddiffuse\" \"rgb reflectance\" [ 0.6 0.4 0.2 ] \"float roughness\" 0";
  for (const std::string& pane : {std::string(kPaint), rough, coat}) {
    const auto scene = LoadWith(PaneBefore(pane, kPaint, kOtherPaint), kGuides);
    const RadianceTile tile = Rendered(*scene);
    for (const char* channel : {"albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"}) {
      EXPECT_EQ(Held(*scene, tile, std::string("denoising_") + channel), Held(*scene, tile, channel))
          << pane << " " << channel;
    }
  }
}

TEST(MirroredLayers, AreThoseOfTheFirstSurfaceIfNothingElseIsSeenInIt) {
  const std::string fog =
      "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 99 99 99 ]\n"
      "MediumInterface \"fog\" \"\" Material \"dielectric\" \"float eta\" 1.0000001 Translate 0 0 3 Shape "
      "\"sphere\" Material \"diffuse\" Translate 99 0 0";
  for (const auto& [pane, integrator] : {std::pair(std::string(kAir), "path"), std::pair(fog, "volpath")}) {
    const bool is_fog = pane == fog;
    std::string text = PaneBefore(pane, is_fog ? kPaint : "Translate 99 0 0", kOtherPaint, integrator);
    const auto scene = LoadWith(text, kGuides);
    const RadianceTile tile = Rendered(*scene);
    for (const char* channel : {"albedo.G", "normal.X", "normal.Z"}) {
      EXPECT_EQ(Held(*scene, tile, std::string("denoising_") + channel), Held(*scene, tile, channel))
          << integrator << " " << channel;
    }
  }
}

TEST(MirroredLayers, LeaveColoursAsTheyAre) {
  for (const char* integrator : {"path", "volpath", "simplepath", "simplevolpath", "randomwalk"}) {
    const std::string text = StageFor(integrator);
    const auto plain = LoadWith(text, {}), guided = LoadWith(text, kGuides);
    const RadianceTile plain_tile = Rendered(*plain), guided_tile = Rendered(*guided);
    for (const char* channel : {"R", "G", "B", "W"})
      EXPECT_EQ(Held(*plain, plain_tile, channel), Held(*guided, guided_tile, channel)) << integrator;
  }
}

}  // namespace
}  // namespace tessera
