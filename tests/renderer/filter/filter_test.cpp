#include "renderer/filter/filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/chi_square.h"

namespace tessera {
namespace {

Parameter FloatParameter(const std::string& name, float value) {
  Parameter parameter;
  parameter.type = "float";
  parameter.name = name;
  parameter.floats = {value};
  return parameter;
}

Entity FilterEntity(const std::string& kind, std::vector<Parameter> parameters = {}) {
  return {"PixelFilter", kind, {}, std::move(parameters)};
}

constexpr const char* kKinds[] = {"box", "gaussian", "mitchell", "sinc", "triangle"};

TEST(Filter, SampledOffsetsFollowTheMagnitudeOfTheFilter) {
  for (const char* kind : kKinds) {
    const Result<Filter> filter = Filter::Read(FilterEntity(kind));
    ASSERT_TRUE(filter) << filter.error().message;
    const Vec2 radius = filter->radius();
    constexpr int kCells = 400;
    double total = 0;
    for (int y = 0; y < kCells; ++y) {
      for (int x = 0; x < kCells; ++x) {
        const Vec2 p{radius.x * (2 * (static_cast<float>(x) + 0.5f) / kCells - 1),
                     radius.y * (2 * (static_cast<float>(y) + 0.5f) / kCells - 1)};
        total += std::abs(filter->Evaluate(p));
      }
    }
    total *= 4.0 * radius.x * radius.y / (kCells * kCells);
    TestRandom random(7);
    ChiSquareGrid grid;
    grid.x0 = -radius.x;
    grid.x1 = radius.x;
    grid.y0 = -radius.y;
    grid.y1 = radius.y;
    const ChiSquareResult result = ChiSquare(
        grid, [&]() -> std::optional<Vec2> { return filter->Sample(random.Next2<Point2>()).offset; },
        [&](double x, double y) {
          return std::abs(filter->Evaluate({static_cast<float>(x), static_cast<float>(y)})) / total;
        });
    EXPECT_TRUE(result.Passes(5)) << kind << ": " << result.text;
  }
}

TEST(Filter, WeightsHaveTheSignOfTheFilter) {
  for (const char* kind : kKinds) {
    const Result<Filter> filter = Filter::Read(FilterEntity(kind));
    ASSERT_TRUE(filter);
    TestRandom random(3);
    int wrong = 0;
    for (int i = 0; i < 20000; ++i) {
      const FilterSample sample = filter->Sample(random.Next2<Point2>());
      const float f = filter->Evaluate(sample.offset);
      if (std::abs(f) > 1e-4f && (f < 0) != (sample.weight < 0)) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << kind;
  }
}

TEST(Filter, RadiusAndShapeComeFromTheScene) {
  const Result<Filter> filter = Filter::Read(FilterEntity("triangle", {FloatParameter("xradius", 3)}));
  ASSERT_TRUE(filter);
  EXPECT_EQ(filter->radius().x, 3);
  EXPECT_EQ(filter->radius().y, 2);
  EXPECT_NE(filter->Evaluate({2.9f, 0}), 0);
  EXPECT_EQ(filter->Evaluate({0, 2.1f}), 0);
}

TEST(Filter, BadParametersAreRefused) {
  EXPECT_FALSE(Filter::Read(FilterEntity("box", {FloatParameter("xradius", -1)})));
  EXPECT_FALSE(Filter::Read(FilterEntity("box", {FloatParameter("radius", 1)})));
  const Result<Filter> misspelt = Filter::Read(FilterEntity("gausian"));
  ASSERT_FALSE(misspelt);
  EXPECT_NE(misspelt.error().message.find("did you mean \"gaussian\"?"), std::string::npos)
      << misspelt.error().message;
}

}  // namespace
}  // namespace tessera
