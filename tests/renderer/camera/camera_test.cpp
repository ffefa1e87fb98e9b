#include "renderer/camera/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/renderer/camera/camera_maker.h"

namespace tessera {
namespace {

TEST(Camera, FieldOfViewSpansTheShorterAxis) {
  const Camera camera = MakeCamera("perspective", {FloatParameter("fov", 60)});
  const Vec3 top = RayAt(camera, {200, 0}).d;
  const Vec3 bottom = RayAt(camera, {200, 200}).d;
  EXPECT_NEAR(AngleBetween(top, bottom), Radians(60), 1e-4f);
  EXPECT_GT(top.y, 0);  // the first row of pixels is the upper one
  EXPECT_NEAR(RayAt(camera, {200, 100}).d.z, 1, 1e-6f);
}

TEST(Camera, LooksFromEyeToLookWithXToTheRight) {
  const std::optional<Transform> look = LookAt({1, 2, 3}, {1, 2, 10}, {0, 1, 0});
  ASSERT_TRUE(look);
  const Camera camera = MakeCamera("perspective", {}, {}, {400, 200}, *look);
  const Ray ray = RayAt(camera, {200, 100});
  EXPECT_NEAR(Length(ray.o), 0, 1e-5f);  // rendering space has its origin at the camera
  EXPECT_NEAR(ray.d.z, 1, 1e-6f);
  const Point3 eye = camera.render_from_world().ToPoint({1, 2, 3});
  EXPECT_NEAR(Length(eye), 0, 1e-5f);
  EXPECT_GT(RayAt(camera, {399, 100}).d.x, 0);
}

TEST(Camera, LensRaysMeetOnThePlaneOfFocus) {
  for (const char* kind : {"perspective", "orthographic"}) {
    const Camera camera =
        MakeCamera(kind, {FloatParameter("lensradius", 0.5f), FloatParameter("focaldistance", 4)});
    EXPECT_TRUE(camera.has_lens());
    const Point2 film{300, 50};
    const Ray a = camera.GenerateRay(film, {0.1f, 0.3f}, 0).ray,
              b = camera.GenerateRay(film, {0.9f, 0.8f}, 0).ray;
    EXPECT_GT(Distance(a.o, b.o), 0.01f);
    const Point3 at_a = a.At((4 - a.o.z) / a.d.z), at_b = b.At((4 - b.o.z) / b.d.z);
    EXPECT_NEAR(Distance(at_a, at_b), 0, 1e-4f) << kind;
    // There a camera without lens sees the same point.
    const Ray pinhole = RayAt(MakeCamera(kind, {}), film);
    ExpectNear(at_a, pinhole.At((4 - pinhole.o.z) / pinhole.d.z), 1e-4f);
  }
}

TEST(Camera, FootprintIsAboutOnePixelWide) {
  const Camera camera = MakeCamera("perspective", {FloatParameter("fov", 40)});
  const Ray centre = RayAt(camera, {200, 100}), next = RayAt(camera, {201, 100});
  const Point3 p = centre.At(5 / centre.d.z);
  const float pixel = Distance(p, next.At(5 / next.d.z));
  const Footprint footprint = camera.ApproximateFootprint(p, {0, 0, -1}, 1);
  // the estimate uses the smallest pixel of the film, which lies in a corner
  EXPECT_LT(Length(footprint.dpdx), pixel * 1.01f);
  EXPECT_GT(Length(footprint.dpdx), pixel * 0.4f);
}

TEST(Camera, ScreenWindowAndFrameAspectRatioChooseTheVisiblePart) {
  // At distance 1 and a field of view of 90 degrees, the image plane has the units of space.
  const auto corner = [](const Camera& camera, Point2 film) {
    const Vec3 d = RayAt(camera, film).d;
    return Point2{d.x / d.z, d.y / d.z};
  };
  const Camera window = MakeCamera("perspective", {FloatParameter("screenwindow", {-0.5f, 1, -2, 0.25f})});
  EXPECT_NEAR(corner(window, {0, 0}).x, -0.5f, 1e-4f);
  EXPECT_NEAR(corner(window, {0, 0}).y, 0.25f, 1e-4f);
  EXPECT_NEAR(corner(window, {400, 200}).x, 1, 1e-4f);
  EXPECT_NEAR(corner(window, {400, 200}).y, -2, 1e-4f);
  const Camera wide = MakeCamera("perspective", {FloatParameter("frameaspectratio", 3)});
  EXPECT_NEAR(corner(wide, {400, 0}).x, 3, 1e-4f);
  EXPECT_NEAR(corner(wide, {400, 0}).y, 1, 1e-4f);
  const Camera tall = MakeCamera("perspective", {FloatParameter("frameaspectratio", 0.5f)});
  EXPECT_NEAR(corner(tall, {400, 0}).x, 1, 1e-4f);
  EXPECT_NEAR(corner(tall, {400, 0}).y, 2, 1e-4f);
  const Camera mirrored = MakeCamera("perspective", {FloatParameter("screenwindow", {1, -1, -1, 1})});
  EXPECT_NEAR(corner(mirrored, {0, 0}).x, 1, 1e-4f);
}

TEST(OrthographicCamera, RaysAreParallelAndStartInTheScreenWindow) {
  const Camera camera = MakeCamera("orthographic", {});
  EXPECT_FALSE(camera.has_lens());
  for (const auto& [film, origin] : {std::pair<Point2, Point3>{{0, 0}, {-2, 1, 0}},
                                     {{400, 0}, {2, 1, 0}},
                                     {{400, 200}, {2, -1, 0}},
                                     {{200, 100}, {0, 0, 0}},
                                     {{250, 50}, {0.5f, 0.5f, 0}}}) {
    ExpectNear(RayAt(camera, film).o, origin, 1e-5f);
    ExpectNear(RayAt(camera, film).d, {0, 0, 1}, 1e-6f);
  }
  const Camera window = MakeCamera("orthographic", {FloatParameter("screenwindow", {-3, 5, 0, 8})});
  ExpectNear(RayAt(window, {100, 150}).o, {-1, 2, 0}, 1e-5f);
}

TEST(OrthographicCamera, FootprintIsThePixelWhereverThePointLies) {
  const std::optional<Transform> look = LookAt({1, 2, 3}, {4, 3, 5}, {0, 1, 0});
  ASSERT_TRUE(look);
  for (const Transform& camera_from_world : {Transform(), *look}) {
    const Camera camera = MakeCamera("orthographic", {}, {}, {400, 200}, camera_from_world);
    for (const Point2 film : {Point2{10, 20}, Point2{390, 150}}) {
      const Ray ray = RayAt(camera, film);
      const Footprint facing = camera.ApproximateFootprint(ray.At(7), -ray.d, 1);
      EXPECT_NEAR(Length(facing.dpdx), 0.01f, 1e-5f);
      EXPECT_NEAR(Length(facing.dpdy), 0.01f, 1e-5f);
      EXPECT_NEAR(Dot(facing.dpdx, ray.d), 0, 1e-6f);
    }
  }
}

TEST(SphericalCamera, EquirectangularRowsAreLatitudesAndColumnsLongitudes) {
  const Camera camera = MakeCamera("spherical", {StringParameter("mapping", "equirectangular")});
  EXPECT_FALSE(camera.has_lens());
  ExpectNear(RayAt(camera, {123, 0}).d, {0, 1, 0}, 1e-6f);
  ExpectNear(RayAt(camera, {123, 200}).d, {0, -1, 0}, 1e-6f);
  ExpectNear(RayAt(camera, {0, 100}).d, {1, 0, 0}, 1e-6f);
  ExpectNear(RayAt(camera, {100, 100}).d, {0, 0, 1}, 1e-6f);
  ExpectNear(RayAt(camera, {200, 100}).d, {-1, 0, 0}, 1e-6f);
  ExpectNear(RayAt(camera, {50, 50}).d, {0.5f, std::sqrt(0.5f), 0.5f}, 1e-6f);
  ExpectNear(RayAt(camera, {50, 50}).o, {0, 0, 0}, 0);
}

TEST(SphericalCamera, EqualAreasOfThePictureAreEqualSolidAngles) {
  const CameraFilm film{128, 128};
  const Camera camera = MakeCamera("spherical", {}, {}, film);
  ExpectNear(RayAt(camera, {64, 64}).d, {0, 1, 0}, 1e-5f);
  ExpectNear(RayAt(camera, {0, 0}).d, {0, -1, 0}, 1e-5f);
  // Caps about the axes, of height 1 - cosine.
  for (const Vec3 axis : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
    for (const float cosine : {0.8f, 0.2f, -0.5f}) {
      int inside = 0;
      for (int y = 0; y < film.height; ++y) {
        for (int x = 0; x < film.width; ++x) {
          const Vec3 d = RayAt(camera, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).d;
          inside += Dot(d, axis) > cosine;
        }
      }
      EXPECT_NEAR(static_cast<float>(inside) / (128 * 128), (1 - cosine) / 2, 0.01f) << cosine;
    }
  }
}

TEST(SphericalCamera, TheOctahedronGoesOnBeyondTheEdges) {
  const Camera camera = MakeCamera("spherical", {}, {}, {128, 128});
  ExpectNear(RayAt(camera, {-0.5f, 20}).d, RayAt(camera, {0.5f, 108}).d, 1e-5f);
  ExpectNear(RayAt(camera, {128.5f, 20}).d, RayAt(camera, {127.5f, 108}).d, 1e-5f);
  ExpectNear(RayAt(camera, {30, -0.5f}).d, RayAt(camera, {98, 0.5f}).d, 1e-5f);
  ExpectNear(RayAt(camera, {30, 128.5f}).d, RayAt(camera, {98, 127.5f}).d, 1e-5f);
  // A filter may be wider than the whole picture.
  const Camera small = MakeCamera("spherical", {}, {}, {1, 1});
  for (const float x : {-3.5f, 0.5f, 4.5f}) EXPECT_NEAR(Length(RayAt(small, {x, -2}).d), 1, 1e-4f);
}

TEST(Camera, BadParametersAreRefused) {
  for (const Parameter& bad :
       {FloatParameter("fov", 0), FloatParameter("fov", 180), FloatParameter("lensradius", -1),
        FloatParameter("focaldistance", 0), FloatParameter("shutterclose", -1), FloatParameter("fovy", 20),
        FloatParameter("screenwindow", {1, 1, 0, 1}), FloatParameter("frameaspectratio", 0)}) {
    EXPECT_FALSE(TryCamera("perspective", {bad}).camera) << bad.name << " " << bad.floats[0];
  }
  EXPECT_FALSE(TryCamera("orthographic", {FloatParameter("fov", 50)}).camera);
  EXPECT_FALSE(TryCamera("spherical", {StringParameter("mapping", "mercator")}).camera);
}

// pbrt swaps times in the wrong order, but only after it has refused them as those of a black picture.
TEST(Camera, AShutterThatDoesNotOpenIsRefused) {
  for (const auto& [open, close] : {std::pair(2.0f, 1.0f), std::pair(1.0f, 1.0f), std::pair(0.0f, -1.0f)}) {
    const auto refused = TryCamera(
        "perspective", {FloatParameter("shutteropen", open), FloatParameter("shutterclose", close)});
    ASSERT_FALSE(refused.camera) << open << " " << close;
    EXPECT_THAT(refused.camera.error().message,
                testing::HasSubstr("the shutter does not open: shutterclose must be later than shutteropen"));
  }
}

TEST(SphericalCamera, ParametersOfOtherCamerasAreReadWithoutEffect) {
  const Camera plain = MakeCamera("spherical", {});
  const Camera other = MakeCamera(
      "spherical", {FloatParameter("lensradius", 2), FloatParameter("focaldistance", 3),
                    FloatParameter("screenwindow", {0, 1, 0, 1}), FloatParameter("frameaspectratio", 3)});
  EXPECT_FALSE(other.has_lens());
  EXPECT_EQ(RayAt(plain, {50, 60}).d, RayAt(other, {50, 60}).d);
}

}  // namespace
}  // namespace tessera
