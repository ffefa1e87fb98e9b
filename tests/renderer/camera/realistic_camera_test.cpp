#include "renderer/camera/realistic_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/renderer/camera/camera_maker.h"

namespace tessera {
namespace {

// A double Gauss lens of 50 mm and f/2: A. W. Tronnier, US patent 2,673,491, in W. J. Smith, "Modern Lens
// Design" (1992), page 312.
const char* const kDoubleGauss = R"(# radius thickness index diameter, mm
29.475 3.76 1.67 25.2
84.83 0.12 1 25.2
19.275 4.025 1.67 23
40.77 3.275 1.699 23
12.75 5.705 1 18
0 4.5 0 17.1
-14.495 1.18 1.603 17
40.77 6.065 1.658 20
-20.385 0.19 1 20
437.065 3.22 1.717 20
-39.73 5 1 20
)";

// Nearly an ideal lens, with the stop at the lens: as thin as its curved surfaces allow.
const char* const kThinLens = "100 1.3 1.5 22\n-100 0.01 1 22\n0 0.01 0 22\n";
// The lensmaker's equation: 1/f = (n - 1) (1/R1 - 1/R2 + (n - 1) t / (n R1 R2)).
constexpr float kThinFocalLength = 0.100217f;

Camera Realistic(const char* lens, std::vector<Parameter> parameters, const CameraFilm& film = {400, 200}) {
  parameters.push_back(StringParameter("lensfile", "lens.dat"));
  return MakeCamera("realistic", std::move(parameters), {{"lens.dat", lens}}, film);
}

std::vector<LensInterface> Interfaces(const char* lens) {
  const auto interfaces = LensSystem::ParseFile(lens);
  EXPECT_TRUE(interfaces) << interfaces.error().message;
  return *interfaces;
}

// Points of a regular grid over the unit square.
std::vector<Point2> Grid(int side) {
  std::vector<Point2> points;
  for (int i = 0; i < side * side; ++i) {
    points.push_back({(static_cast<float>(i % side) + 0.5f) / static_cast<float>(side),
                      (static_cast<float>(i / side) + 0.5f) / static_cast<float>(side)});
  }
  return points;
}

float MeanWeight(const Camera& camera, Point2 film) {
  double sum = 0;
  constexpr int kSide = 200;
  for (const Point2 u : Grid(kSide)) sum += camera.GenerateRay(film, u, 0).weight;
  return static_cast<float>(sum / (kSide * kSide));
}

TEST(LensSystem, FocalLengthsAreThoseOfTheDesigns) {
  const auto gauss = LensSystem::FindCardinalPoints(Interfaces(kDoubleGauss));
  ASSERT_TRUE(gauss);
  EXPECT_NEAR(gauss->focal_length, 0.05, 0.0005);
  const auto thin = LensSystem::FindCardinalPoints(Interfaces(kThinLens));
  ASSERT_TRUE(thin);
  EXPECT_NEAR(thin->focal_length, kThinFocalLength, 1e-5);
  EXPECT_FALSE(LensSystem::FindCardinalPoints(Interfaces("-100 1 1.5 40\n100 1 1 40\n")));
}

TEST(LensSystem, ParaxialRaysCrossTheAxisAtTheFocalPoint) {
  std::vector<LensInterface> interfaces = Interfaces(kDoubleGauss);
  const auto points = LensSystem::FindCardinalPoints(interfaces);
  ASSERT_TRUE(points);
  // From the focal point behind the lens, rays leave it parallel to the axis at the height f tan(angle).
  interfaces.back().thickness = static_cast<float>(points->focal_length - points->film_principal);
  const LensSystem lens(interfaces);
  const auto ray = lens.Trace({0, 0, 0}, Normalize(Vec3{0.02f, 0, 1}), Aperture());
  ASSERT_TRUE(ray);
  EXPECT_NEAR(ray->d.x, 0, 2e-5f);
  EXPECT_NEAR(ray->o.x, 0.02f * 0.05f, 1e-5f);
}

TEST(LensSystem, FilmDistanceSolvesTheLensEquation) {
  const auto thin = LensSystem::FindCardinalPoints(Interfaces(kThinLens));
  ASSERT_TRUE(thin);
  for (const double distance : {0.5, 1.0, 10.0, 1e6}) {
    const auto image = LensSystem::FilmDistance(*thin, distance);
    ASSERT_TRUE(image);
    EXPECT_NEAR(1 / *image + 1 / (distance - *image), 1 / static_cast<double>(kThinFocalLength), 0.1);
  }
  EXPECT_FALSE(LensSystem::FilmDistance(*thin, 0.39));  // nearer than four focal lengths
}

TEST(RealisticCamera, AThinLensSeesWhatTheIdealLensSees) {
  const float distance = 2;
  const CameraFilm film{400, 200, 20};
  const Camera camera = Realistic(
      kThinLens, {FloatParameter("aperturediameter", 8), FloatParameter("focusdistance", distance)}, film);
  // With thin lenses, f = 1 / (1/image + 1/object) and image + object = distance.
  const float image = (distance - std::sqrt(distance * distance - 4 * distance * kThinFocalLength)) / 2;
  const float film_width = 0.02f / std::sqrt(1.25f);
  for (const Point2 place : {Point2{200, 100}, Point2{350, 100}, Point2{30, 190}, Point2{0, 0}}) {
    const float magnification = (distance - image) / image;
    const Point3 object{(place.x / 400 - 0.5f) * film_width * magnification,
                        (0.5f - place.y / 200) * film_width / 2 * magnification, distance};
    int rays = 0;
    for (const Point2 u : Grid(12)) {
      const CameraSample sample = camera.GenerateRay(place, u, 0);
      if (sample.weight == 0) continue;
      ++rays;
      const Point3 p = sample.ray.At((distance - sample.ray.o.z) / sample.ray.d.z);
      ExpectNear(p, object, 0.002f);
    }
    EXPECT_GT(rays, 80);  // of 144 in a square around a disk
  }
}

TEST(RealisticCamera, IrradianceIsPiTimesTheSquaredSineAndFallsWithTheFourthPowerOfTheCosine) {
  const CameraFilm film{400, 400, 60};
  const Camera camera = Realistic(
      kThinLens, {FloatParameter("aperturediameter", 20), FloatParameter("focusdistance", 1000)}, film);
  const float axis = MeanWeight(camera, {200, 200});
  const float d = kThinFocalLength;
  EXPECT_NEAR(axis, kPi * Sqr(0.01f) / (Sqr(0.01f) + Sqr(d)), 0.015f * axis);
  for (const Point2 place : {Point2{300, 200}, Point2{200, 20}, Point2{390, 390}}) {
    const float film_side = 0.06f / std::sqrt(2.0f);
    const float offset = film_side * std::sqrt(Sqr(place.x / 400 - 0.5f) + Sqr(place.y / 400 - 0.5f));
    const float cosine2 = Sqr(d) / (Sqr(d) + Sqr(offset));
    EXPECT_NEAR(MeanWeight(camera, place) / axis, Sqr(cosine2), 0.02f);
  }
}

TEST(RealisticCamera, ThePictureIsUpright) {
  const Camera camera = Realistic(kDoubleGauss, {FloatParameter("aperturediameter", 5)});
  const CameraSample left = camera.GenerateRay({40, 100}, {0.5f, 0.5f}, 0);
  const CameraSample top = camera.GenerateRay({200, 20}, {0.5f, 0.5f}, 0);
  ASSERT_GT(left.weight, 0);
  ASSERT_GT(top.weight, 0);
  EXPECT_LT(left.ray.d.x, -0.1f);
  EXPECT_GT(top.ray.d.y, 0.05f);
}

TEST(RealisticCamera, FocusesAtTheDistanceFromTheFilm) {
  for (const float distance : {0.5f, 2.0f, 20.0f}) {
    const Camera camera = Realistic(
        kDoubleGauss, {FloatParameter("aperturediameter", 2), FloatParameter("focusdistance", distance)});
    // From the middle of the film, rays cross the axis at the plane of focus.
    for (const Point2 u : {Point2{0.2f, 0.5f}, Point2{0.5f, 0.8f}}) {
      const CameraSample sample = camera.GenerateRay({200, 100}, u, 0);
      ASSERT_GT(sample.weight, 0);
      const Point3 p = sample.ray.At((distance - sample.ray.o.z) / sample.ray.d.z);
      EXPECT_NEAR(std::sqrt(p.x * p.x + p.y * p.y), 0, 2e-4f * distance);
    }
  }
}

// Deterministic points in the unit square.
Point2 Halton(int i) {
  Point2 p;
  float f = 0.5f;
  for (int n = i; n > 0; n /= 2, f /= 2) p.x += f * static_cast<float>(n % 2);
  f = 1.0f / 3;
  for (int n = i; n > 0; n /= 3, f /= 3) p.y += f * static_cast<float>(n % 3);
  return p;
}

TEST(ExitPupil, EveryRayThatPassesLiesInTheBounds) {
  constexpr float kFilmRadius = 0.0175f;
  for (const float diameter_mm : {17.1f, 8.0f, 1.0f, 0.1f}) {
    std::vector<LensInterface> interfaces = Interfaces(kDoubleGauss);
    interfaces.back().thickness = 0.0364f;
    interfaces[5].diameter = diameter_mm * 1e-3f;
    const LensSystem lens(interfaces);
    const ExitPupil pupil(lens, 1, kFilmRadius);
    int passed = 0;
    for (int place = 0; place < 200; ++place) {
      const float x = kFilmRadius * (static_cast<float>(place) + 0.37f) / 200;
      const std::optional<PupilBox>& box = pupil.BoxAt(x);
      // Few points of the plane pass a small stop: those near the box are tried as well as all others.
      for (const float scale : {1.5f * lens.rear_radius(), box ? 1.2f * box->y : 0}) {
        const float centre = box && scale < lens.rear_radius() ? (box->x0 + box->x1) / 2 : 0;
        for (int i = 1; i < 2000; ++i) {
          const Point2 u = Halton(i);
          const Point2 p{centre + (2 * u.x - 1) * scale, (2 * u.y - 1) * scale};
          const Vec3 d = Normalize(Vec3{p.x - x, p.y, lens.rear_z()});
          if (!lens.Trace({x, 0, 0}, d, Aperture())) continue;
          ++passed;
          ASSERT_TRUE(box) << x;
          EXPECT_TRUE(p.x >= box->x0 && p.x <= box->x1 && std::abs(p.y) <= box->y)
              << diameter_mm << " mm, film " << x << ": " << p.x << " " << p.y;
        }
      }
    }
    EXPECT_GT(passed, 50000) << diameter_mm;
  }
}

TEST(ExitPupil, MostSamplesOnTheAxisPass) {
  for (const float diameter : {1.0f, 5.0f, 17.0f}) {
    const Camera camera = Realistic(kDoubleGauss, {FloatParameter("aperturediameter", diameter)});
    int passed = 0;
    for (const Point2 u : Grid(50)) passed += camera.GenerateRay({200, 100}, u, 0).weight > 0;
    // A disk fills pi / 4 of its box; the margin of the bounds takes the rest.
    EXPECT_GT(passed, 0.6 * 2500) << diameter;
    EXPECT_LT(passed, 0.786 * 2500) << diameter;
  }
}

Aperture ReadAperture(const std::string& name, std::map<std::string, std::string> texts = {}) {
  const Entity entity{"Camera", "realistic", {}, {StringParameter("aperture", name)}};
  ParameterReader reader(entity);
  MemoryFiles files(std::move(texts));
  ImageCache images(files);
  Diagnostics diagnostics;
  const Aperture aperture = Aperture::Read({reader, {400, 200}, images, diagnostics});
  const Result<void> done = reader.Finish();
  EXPECT_TRUE(done) << done.error().message;
  return aperture;
}

std::string GreyImage(int width, int height, const std::vector<float>& values) {
  std::string file = "Pf\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  for (const float value : values) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    file.append(bytes, sizeof value);
  }
  return file;
}

// Two texels: black on the left, bright on the right.
std::string HalfImage() {
  return GreyImage(2, 1, {0, 0.25f});
}

TEST(Aperture, EveryShapePassesAsMuchAsTheCircle) {
  constexpr int kTexels = 64;
  const std::string ramp = [] {
    std::vector<float> values;
    for (int i = 0; i < kTexels * kTexels; ++i) values.push_back(static_cast<float>(i % kTexels));
    return GreyImage(kTexels, kTexels, values);
  }();
  for (const char* name : {"", "gaussian", "square", "pentagon", "star", "ramp.pfm"}) {
    const Aperture aperture = ReadAperture(name, {{"ramp.pfm", ramp}});
    double sum = 0;
    constexpr int kSide = 600;
    for (const Point2 u : Grid(kSide)) sum += aperture.Transmittance({2 * u.x - 1, 2 * u.y - 1});
    // An image loses what its interpolation carries over the border.
    const double tolerance = std::string(name) == "ramp.pfm" ? 0.05 : 0.02;
    EXPECT_NEAR(sum * 4 / (kSide * kSide), static_cast<double>(kPi), tolerance) << name;
  }
}

TEST(Aperture, ShapesAreWhereTheyShouldBe) {
  const Aperture square = ReadAperture("square");
  EXPECT_NEAR(square.Transmittance({0.49f, -0.49f}), kPi, 1e-5f);
  EXPECT_EQ(square.Transmittance({0.51f, 0}), 0);
  const Aperture pentagon = ReadAperture("pentagon");
  EXPECT_GT(pentagon.Transmittance({0, -0.79f}), 0);  // a corner
  EXPECT_EQ(pentagon.Transmittance({0, 0.66f}), 0);   // beyond the middle of a side, at 0.8 cos(36 degrees)
  EXPECT_GT(pentagon.Transmittance({0, 0.64f}), 0);
  const Aperture star = ReadAperture("star");
  EXPECT_GT(star.Transmittance({-0.95f, 0}), 0);
  EXPECT_EQ(star.Transmittance({0.5f, 0}), 0);
  EXPECT_GT(star.Transmittance({0.3f, 0}), 0);
  const Aperture gaussian = ReadAperture("gaussian");
  EXPECT_GT(gaussian.Transmittance({0, 0}), gaussian.Transmittance({0.5f, 0}));
  EXPECT_NEAR(gaussian.Transmittance({1, 0}), 0, 1e-6f);
  const Aperture half = ReadAperture("half.pfm", {{"half.pfm", HalfImage()}});
  EXPECT_EQ(half.Transmittance({-0.6f, 0}), 0);
  EXPECT_NEAR(half.Transmittance({0.5f, 0}), kPi / 2, 1e-5f);
}

TEST(RealisticCamera, AShapedApertureKeepsTheBrightness) {
  const Camera circle = Realistic(kThinLens, {FloatParameter("aperturediameter", 10)});
  for (const char* name : {"gaussian", "square", "pentagon", "star"}) {
    const Camera shaped =
        Realistic(kThinLens, {FloatParameter("aperturediameter", 10), StringParameter("aperture", name)});
    EXPECT_NEAR(MeanWeight(shaped, {200, 100}) / MeanWeight(circle, {200, 100}), 1, 0.02f) << name;
  }
}

std::string Refusal(std::vector<Parameter> parameters, const std::string& lens) {
  const ReadCamera read = TryCamera("realistic", std::move(parameters), {{"lens.dat", lens}});
  return read.camera ? "" : read.camera.error().message;
}

TEST(RealisticCamera, BadLensesAreRefusedWithTheReason) {
  const auto with = [](const std::string& lens, std::vector<Parameter> parameters = {}) {
    parameters.push_back(StringParameter("lensfile", "lens.dat"));
    return Refusal(std::move(parameters), lens);
  };
  EXPECT_EQ(with(kDoubleGauss), "");
  EXPECT_THAT(Refusal({}, kDoubleGauss), testing::HasSubstr("lensfile"));
  EXPECT_THAT(Refusal({StringParameter("lensfile", "none.dat")}, ""), testing::HasSubstr("none.dat"));
  EXPECT_THAT(with("1 2 3"), testing::HasSubstr("3 numbers"));
  EXPECT_THAT(with(""), testing::HasSubstr("0 numbers"));
  EXPECT_THAT(with("100 1 glass 4"), testing::HasSubstr("line 1"));
  EXPECT_THAT(with("100 1 1.5 40\n-100 1 1 -4"), testing::HasSubstr("interface 2"));
  EXPECT_THAT(with("100 1 -1.5 40\n-100 1 1 4"), testing::HasSubstr("interface 1"));
  EXPECT_THAT(with("inf 1 1.5 40\n-100 1 1 4"), testing::HasSubstr("not finite"));
  EXPECT_THAT(with("-100 1 1.5 40\n100 1 1 40"), testing::HasSubstr("does not focus"));
  EXPECT_THAT(with(kDoubleGauss, {FloatParameter("focusdistance", 0.1f)}),
              testing::HasSubstr("cannot focus"));
  EXPECT_THAT(with(kDoubleGauss, {FloatParameter("aperturediameter", 0)}),
              testing::HasSubstr("aperturediameter"));
  EXPECT_THAT(with(kDoubleGauss, {StringParameter("aperture", "hexagon")}), testing::HasSubstr("hexagon"));
  EXPECT_THAT(with(kDoubleGauss, {FloatParameter("fov", 30)}), testing::HasSubstr("fov"));
}

TEST(RealisticCamera, AnApertureLargerThanTheStopIsReducedToIt) {
  const auto read = [](float diameter) {
    return TryCamera("realistic",
                     {StringParameter("lensfile", "lens.dat"), FloatParameter("aperturediameter", diameter)},
                     {{"lens.dat", kDoubleGauss}});
  };
  const ReadCamera open = read(17.1f), larger = read(30);
  ASSERT_TRUE(open.camera && larger.camera);
  EXPECT_TRUE(open.warnings.empty());
  ASSERT_EQ(larger.warnings.size(), 1u);
  EXPECT_THAT(larger.warnings[0], testing::HasSubstr("17.1 mm instead of 30 mm"));
  EXPECT_EQ(MeanWeight(*open.camera, {200, 100}), MeanWeight(*larger.camera, {200, 100}));
}

}  // namespace
}  // namespace tessera
