// Shapes far from the origin of the world, near a camera that is there too, in closed form.
#include <gtest/gtest.h>

#include <string>

#include "tests/renderer/scene/moving_pictures.h"

namespace tessera {
namespace {

struct Placement {
  const char* name;
  std::string before, after;  // the shape
};

// 5 in front of a camera at (300, 200, -500).
constexpr const char* kThere = "Translate 300 200 -495 Rotate 70 1 0.2 0 Scale 2 2 2 ";

std::vector<Placement> Placements() {
  return {
      {"in the world", kThere, ""},
      {"in an object", "ObjectBegin \"o\" Rotate -10 1 0 0 ",
       " ObjectEnd " + std::string(kThere) + "ObjectInstance \"o\""},
      {"moving", kThere + std::string("ActiveTransform EndTime Rotate 7 0 0 1 ActiveTransform All "), ""}};
}

float CenterOf(const std::string& world) {
  const std::vector<float> green =
      GreenOf(MovingHead("\"volpath\"", "Translate -300 -200 500 TransformTimes 0 1",
                         "\"float shutteropen\" 0 \"float shutterclose\" 1") +
              world);
  return green[kMovingSize * kMovingSize / 2 + kMovingSize / 2];
}

// A convex body of reflectance 0.5 under a sky of radiance 1 reflects 0.5 everywhere, unless it shades
// itself.
TEST(FarShapes, DoNotShadeThemselves) {
  for (const char* shape : {"disk", "cylinder", "sphere"}) {
    for (const Placement& placement : Placements()) {
      const float center = CenterOf(
          "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ] Material \"diffuse\" \"rgb reflectance\" "
          "[ 0.5 0.5 0.5 ] " +
          placement.before + "Shape \"" + shape + "\" " + placement.after);
      EXPECT_NEAR(center, 0.5, 2e-3) << shape << " " << placement.name;
    }
  }
}

// A ray that found an emitter twice would count its radiance twice.
TEST(FarShapes, ThatEmitHaveTheirRadiance) {
  for (const char* shape : {"disk", "sphere"}) {
    const float center = CenterOf("AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] \"bool twosided\" true " +
                                  std::string(kThere) + "Shape \"" + shape + "\"");
    EXPECT_NEAR(center, 1, 5e-3) << shape;
  }
}

}  // namespace
}  // namespace tessera
