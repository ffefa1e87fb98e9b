// The layer "motion" against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/renderer/scene/layer_scenes.h"

namespace tessera {
namespace {

// A camera that looks along z with a field of 90 degrees over 40 pixels: a point at distance z moves 20 dx /
// z pixels.
constexpr const char* kMotionFilm = R"(
Film "rgb" "integer xresolution" 40 "integer yresolution" 40 "bool savefp16" false
PixelFilter "box"
Option "disablepixeljitter" true
)";

Vec2 MotionAt(const std::string& text, int x, int y) {
  const auto scene = LoadWith(text, {"motion"});
  const RadianceTile tile = *scene->Render({x, y, x + 1, y + 1}, {}, {0, 1}, nullptr);
  const ChannelLayout layout = scene->frame().Layout();
  return {tile.sums[*layout.SlotOf("motion.X")], tile.sums[*layout.SlotOf("motion.Y")]};
}

TEST(MotionLayer, MotionOfAShapeIsItsWayOverThePicture) {
  const std::string text = std::string(kMotionFilm) + R"(
Scale -1 1 1
Camera "perspective" "float fov" 90
WorldBegin
LightSource "infinite"
ActiveTransform EndTime
Translate 0.4 -0.2 0
ActiveTransform All
Translate 0 0 4
Scale 9 9 1
Shape "bilinearmesh" "point3 P" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]
)";
  const Vec2 motion = MotionAt(text, 25, 12);
  // Scale -1 makes world x run to the right of the picture.
  EXPECT_NEAR(std::abs(motion.x), 20 * 0.4f / 4, 0.01f);
  EXPECT_NEAR(motion.y, 20 * 0.2f / 4, 0.01f) << "down is positive";
}

TEST(MotionLayer, MotionOfTheCameraIsThatOfWhatItSees) {
  const std::string text = std::string(kMotionFilm) + R"(
ActiveTransform EndTime
Translate -0.5 0 0
ActiveTransform All
Camera "perspective" "float fov" 90
WorldBegin
LightSource "infinite"
Translate 0 0 5
Scale 30 30 1
Shape "bilinearmesh" "point3 P" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]
)";
  const Vec2 here = MotionAt(text, 20, 20), there = MotionAt(text, 3, 35);
  EXPECT_NEAR(std::abs(here.x), 20 * 0.5f / 5, 0.01f);
  EXPECT_NEAR(here.y, 0, 0.01f);
  EXPECT_NEAR(there.x, here.x, 0.01f) << "a plane across the view moves as a whole";
}

TEST(MotionLayer, MotionTowardsACameraSpreadsFromTheMiddle) {
  for (const char* camera : {"\"perspective\" \"float fov\" 90", "\"orthographic\"", "\"spherical\""}) {
    const std::string text = std::string(kMotionFilm) + "Camera " + camera + R"(
WorldBegin
LightSource "infinite"
ActiveTransform EndTime
Translate 0 0 -1
ActiveTransform All
Translate 0 0 5
Scale 90 90 1
Shape "bilinearmesh" "point3 P" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]
)";
    const Vec2 motion = MotionAt(text, 30, 20);
    if (std::string(camera).find("ortho") != std::string::npos) {
      EXPECT_NEAR(motion.x, 0, 0.01f);
      continue;
    }
    EXPECT_GT(motion.x, 0.1f) << camera;
    if (std::string(camera).find("persp") != std::string::npos) {
      // 10.5 pixels from the middle, at 5 units when the shutter is in its middle at 4.5.
      EXPECT_NEAR(motion.x, 10.5f * 4.5f / 4 - 10.5f * 4.5f / 5, 0.01f);
    }
  }
}

}  // namespace
}  // namespace tessera
