// Where lights are hidden: what is sampled less often there, and that the answer depends on the scene alone.
#include "renderer/integrator/light_visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <thread>
#include <vector>

#include "renderer/math/sampling.h"
#include "tests/chi_square.h"
#include "tests/renderer/scene/built_world.h"

namespace tessera {
namespace {

// A lamp 8 away from the camera behind a wall 4 away, which hides it from everything near the camera.
std::string LampBehindAWall(const std::string& lamp_options) {
  return R"(
Material "diffuse"
Shape "bilinearmesh" "point3 P" [ -50 -50 4  50 -50 4  -50 50 4  50 50 4 ]
AreaLightSource "diffuse" "rgb L" [ 3 3 3 ] "bool twosided" true )" +
         lamp_options + R"(
Shape "bilinearmesh" "point3 P" [ -1 -1 8  1 -1 8  -1 1 8  1 1 8 ]
)";
}

TEST(LightVisibility, LightsAreSampledLessOftenWhereAWallHidesThem) {
  const auto world = BuiltWorld(LampBehindAWall(""));
  const LightVisibility visibility(*world);
  TestRandom random(1);
  for (int i = 0; i < 100; ++i) {
    const float x = 4 * random.Next() - 2, y = 4 * random.Next() - 2, z = 3 * random.Next();
    EXPECT_LT(visibility.SamplingProbability({x, y, z}), 1);
    EXPECT_GT(visibility.SamplingProbability({x, y, z}), 0);
    EXPECT_EQ(visibility.SamplingProbability({x, y, z + 4.6f}), 1);
  }
}

TEST(LightVisibility, WallsHideNoLightsThatCastNoShadows) {
  const auto world = BuiltWorld(LampBehindAWall("\"bool cast_shadows\" false"));
  const LightVisibility visibility(*world);
  EXPECT_EQ(visibility.SamplingProbability({0.1f, 0.2f, 1}), 1);
}

TEST(LightVisibility, EveryPointHasAProbability) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const char* text :
       {"", "Shape \"sphere\" \"float radius\" 1e-30", "Shape \"sphere\" \"float radius\" 1e16"}) {
    const auto world = BuiltWorld(text);
    const LightVisibility visibility(*world);
    for (const Point3 p :
         {Point3{}, Point3{1e-38f, 0, 0}, Point3{-1e-20f, 1, 3}, Point3{3e38f, -3e38f, 1},
          Point3{kInfinity, 0, -kInfinity}, Point3{kNan, 1, 1}, Point3{1, kNan, kInfinity}}) {
      EXPECT_GT(visibility.SamplingProbability(p), 0);
      EXPECT_LE(visibility.SamplingProbability(p), 1);
    }
  }
}

TEST(LightVisibility, DependsNeitherOnTheOrderOfPointsNorOnThreads) {
  const auto world = BuiltWorld(kRoomLitThroughAGap);
  TestRandom random(2);
  std::vector<Point3> points(3000);
  for (Point3& p : points) p = {4 * random.Next() - 2, 3 * random.Next() - 1, 10 * random.Next() - 1};
  const LightVisibility first(*world), second(*world);
  std::vector<float> expected;
  for (const Point3 p : points) expected.push_back(first.SamplingProbability(p));
  const auto hidden = std::ranges::count_if(expected, [](float share) { return share < 1; });
  EXPECT_GT(hidden, 300);
  EXPECT_LT(hidden, 2700);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (size_t i = points.size(); i-- > 0;) EXPECT_EQ(second.SamplingProbability(points[i]), expected[i]);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace tessera
