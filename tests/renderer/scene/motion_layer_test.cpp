// The layer "motion" against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/math/vec.h"
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

// A point of the sky at the angle a from the middle is 20 tan(a) pixels to the side.
TEST(MotionLayer, TheSkyMovesIfTheCameraTurns) {
  const std::string text = std::string(kMotionFilm) + R"(
ActiveTransform EndTime
Rotate 10 0 1 0
ActiveTransform All
Camera "perspective" "float fov" 90
WorldBegin
LightSource "infinite"
)";
  constexpr float kTurn = 10 * kPi / 180;
  for (const int x : {20, 5, 33}) {
    // The shutter is in its middle when the ray is traced.
    const float middle = std::atan((static_cast<float>(x) + 0.5f - 20) / 20);
    const float way = 20 * (std::tan(middle + kTurn / 2) - std::tan(middle - kTurn / 2));
    const Vec2 motion = MotionAt(text, x, 20);
    EXPECT_NEAR(std::abs(motion.x), way, 0.01f) << x;
    EXPECT_NEAR(motion.y, 0, 0.2f) << x;
  }
  const std::string shifted = [&] {
    std::string still = text;
    still.replace(still.find("Rotate 10 0 1 0"), 15, "Translate 3 1 2");
    return still;
  }();
  EXPECT_NEAR(MotionAt(shifted, 5, 5).x, 0, 0.01f) << "the sky is infinitely far away";
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

// Half a second into the animation the wall is at half its way, and moves by a 24th of it until the next
// frame.
TEST(MotionLayer, MotionOfAFrameThatShowsAMomentReachesToTheNextFrame) {
  const std::string text = std::string(kMotionFilm) + R"(
Camera "perspective" "float fov" 90
WorldBegin
LightSource "infinite"
Material "diffuse"
ActiveTransform EndTime
Translate 4 -2 0
ActiveTransform All
Translate 0 0 4
Scale 9 9 1
Shape "bilinearmesh" "point3 P" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]
)";
  const auto load = [&](const std::set<std::string>& layers) {
    MemoryFiles files({{"scene.pbrt", text}});
    RenderOptions options;
    options.aovs = layers;
    options.samples_per_pixel = 4;
    options.time = 0.5;
    options.time_step = 1.0 / 24;
    return std::move(*Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender));
  };
  const auto scene = load({"motion"}), plain = load({});
  const PixelBounds all{0, 0, 40, 40};
  const RadianceTile tile = *scene->Render(all, {}, {0, 4}, nullptr);
  const RadianceTile still = *plain->Render(all, {}, {0, 4}, nullptr);
  const ChannelLayout layout = scene->frame().Layout(), plain_layout = plain->frame().Layout();
  int seen = 0;
  for (size_t pixel = 0; pixel < 1600; ++pixel) {
    const float* const values = &tile.sums[pixel * layout.shape().stride()];
    EXPECT_NEAR(values[*layout.SlotOf("G")],
                still.sums[pixel * plain_layout.shape().stride() + *plain_layout.SlotOf("G")], 1e-3f);
    if (values[*layout.SlotOf("depth.Z")] == 0) continue;
    ++seen;
    ASSERT_NEAR(values[*layout.SlotOf("motion.X")], 20 * 4.0f / 24 / 4, 0.01f);
    ASSERT_NEAR(values[*layout.SlotOf("motion.Y")], 20 * 2.0f / 24 / 4, 0.01f);
  }
  EXPECT_GT(seen, 1000);
}

}  // namespace
}  // namespace tessera
