#include "renderer/camera/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera {
namespace {

Parameter FloatParameter(const std::string& name, float value) {
  Parameter parameter;
  parameter.type = "float";
  parameter.name = name;
  parameter.floats = {value};
  return parameter;
}

Camera MakeCamera(std::vector<Parameter> parameters, const Transform& camera_from_world = {}) {
  const Entity entity{"Camera", "perspective", {}, std::move(parameters)};
  Result<Camera> camera = Camera::Read(entity, camera_from_world, 400, 200);
  TESSERA_CHECK(camera.has_value());
  return *camera;
}

TEST(Camera, FieldOfViewSpansTheShorterAxis) {
  const Camera camera = MakeCamera({FloatParameter("fov", 60)});
  const Vec3 top = camera.GenerateRay({200, 0}, {0.5f, 0.5f}, 0).d;
  const Vec3 bottom = camera.GenerateRay({200, 200}, {0.5f, 0.5f}, 0).d;
  EXPECT_NEAR(AngleBetween(top, bottom), Radians(60), 1e-4f);
  EXPECT_GT(top.y, 0);  // the first row of pixels is the upper one
  const Vec3 centre = camera.GenerateRay({200, 100}, {0.5f, 0.5f}, 0).d;
  EXPECT_NEAR(centre.z, 1, 1e-6f);
}

TEST(Camera, LooksFromEyeToLookWithXToTheRight) {
  const std::optional<Transform> look = LookAt({1, 2, 3}, {1, 2, 10}, {0, 1, 0});
  ASSERT_TRUE(look);
  const Camera camera = MakeCamera({}, *look);
  const Ray ray = camera.GenerateRay({200, 100}, {0.5f, 0.5f}, 0);
  EXPECT_NEAR(Length(ray.o), 0, 1e-5f);  // rendering space has its origin at the camera
  EXPECT_NEAR(ray.d.z, 1, 1e-6f);
  const Point3 eye = camera.render_from_world().ToPoint({1, 2, 3});
  EXPECT_NEAR(Length(eye), 0, 1e-5f);
  EXPECT_GT(camera.GenerateRay({399, 100}, {0.5f, 0.5f}, 0).d.x, 0);
}

TEST(Camera, LensRaysMeetOnThePlaneOfFocus) {
  const Camera camera = MakeCamera({FloatParameter("lensradius", 0.5f), FloatParameter("focaldistance", 4)});
  const Point2 film{300, 50};
  const Ray a = camera.GenerateRay(film, {0.1f, 0.3f}, 0), b = camera.GenerateRay(film, {0.9f, 0.8f}, 0);
  EXPECT_GT(Distance(a.o, b.o), 0.01f);
  const Point3 at_a = a.At((4 - a.o.z) / a.d.z), at_b = b.At((4 - b.o.z) / b.d.z);
  EXPECT_NEAR(Distance(at_a, at_b), 0, 1e-4f);
}

TEST(Camera, FootprintIsAboutOnePixelWide) {
  const Camera camera = MakeCamera({FloatParameter("fov", 40)});
  const Ray centre = camera.GenerateRay({200, 100}, {0.5f, 0.5f}, 0),
            next = camera.GenerateRay({201, 100}, {0.5f, 0.5f}, 0);
  const Point3 p = centre.At(5 / centre.d.z);
  const float pixel = Distance(p, next.At(5 / next.d.z));
  const Footprint footprint = camera.ApproximateFootprint(p, {0, 0, -1}, 1);
  // the estimate uses the smallest pixel of the film, which lies in a corner
  EXPECT_LT(Length(footprint.dpdx), pixel * 1.01f);
  EXPECT_GT(Length(footprint.dpdx), pixel * 0.4f);
}

TEST(Camera, BadParametersAreRefused) {
  for (const Parameter& bad :
       {FloatParameter("fov", 0), FloatParameter("fov", 180), FloatParameter("lensradius", -1),
        FloatParameter("focaldistance", 0), FloatParameter("shutterclose", -1), FloatParameter("fovy", 20)}) {
    const Entity entity{"Camera", "perspective", {}, {bad}};
    EXPECT_FALSE(Camera::Read(entity, {}, 400, 200)) << bad.name << " " << bad.floats[0];
  }
}

}  // namespace
}  // namespace tessera
