#include "renderer/light/ies_profile.h"

#include <fmt/format.h>

#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

// A file of type C without tilt. The angles and candela values are lists of numbers.
std::string Ies(const std::string& counts, const std::string& angles_and_candela,
                const std::string& multiplier = "1") {
  return "IESNA:LM-63-2002\n[TEST] made by hand\nTILT=NONE\n1 1000 " + multiplier + " " + counts +
         " 1 2 0 0 0\n1 1 50\n" + angles_and_candela + "\n";
}

IesProfile Profile(const std::string& text) {
  Result<IesProfile> profile = IesProfile::Read(text);
  EXPECT_TRUE(profile) << profile.error().message;
  return profile ? *std::move(profile) : IesProfile();
}

// The direction of a vertical and a horizontal angle.
Vec3 Direction(float vertical, float horizontal) {
  const float sine = std::sin(Radians(vertical));
  return {sine * std::cos(Radians(horizontal)), sine * std::sin(Radians(horizontal)),
          -std::cos(Radians(vertical))};
}

float MeanByQuadrature(const IesProfile& profile) {
  constexpr int kSide = 600;
  double sum = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Point2 u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                   (static_cast<float>(i / kSide) + 0.5f) / kSide};
    sum += profile.Intensity(SampleUniformSphere(u));
  }
  return static_cast<float>(sum / (kSide * kSide));
}

TEST(IesProfile, IsInterpolatedBetweenTheAnglesThatWereMeasured) {
  const IesProfile profile = Profile(Ies("3 3", "0 60 90  0 45 90  100 50 0  100 70 10  100 90 20", "2"));
  EXPECT_NEAR(profile.Intensity({0, 0, -1}), 200, 1e-3f);
  EXPECT_NEAR(profile.Intensity(Direction(30, 0)), 150, 1e-3f);
  EXPECT_NEAR(profile.Intensity(Direction(60, 45)), 140, 1e-3f);
  EXPECT_NEAR(profile.Intensity(Direction(60, 22.5f)), 120, 1e-3f);
  EXPECT_NEAR(profile.Intensity(Direction(75, 90)), (90 + 20), 1e-3f);
  EXPECT_EQ(profile.Intensity(Direction(91, 10)), 0);
  EXPECT_EQ(profile.Intensity({0, 0, 1}), 0);
}

struct Circle {
  const char* angles;  // one ring of candela values follows the vertical angles 0 and 180
  std::vector<std::pair<float, float>> at;  // horizontal angle and the intensity there
};

TEST(IesProfile, CoversTheCircleByTheSymmetryOfItsAngles) {
  const Circle circles[] = {
      {"2 1|0 180  0  5 5", {{0, 5}, {123, 5}, {300, 5}}},
      {"2 2|0 180  0 90  10 10 20 20", {{45, 15}, {90, 20}, {135, 15}, {180, 10}, {225, 15}, {315, 15}}},
      {"2 2|0 180  0 180  10 10 20 20", {{90, 15}, {180, 20}, {270, 15}, {315, 12.5f}}},
      {"2 3|0 180  90 180 270  10 10 20 20 30 30", {{90, 10}, {0, 20}, {45, 15}, {315, 25}, {180, 20}}},
      {"2 3|0 180  0 180 360  10 10 20 20 10 10", {{90, 15}, {270, 15}}},
      {"2 4|0 180  0 90 180 270  10 10 20 20 30 30 40 40", {{45, 15}, {270, 40}, {315, 25}}},
  };
  for (const Circle& circle : circles) {
    const std::string text = circle.angles;
    const size_t bar = text.find('|');
    const IesProfile profile = Profile(Ies(text.substr(0, bar), text.substr(bar + 1)));
    for (const auto& [angle, intensity] : circle.at)
      EXPECT_NEAR(profile.Intensity(Direction(90, angle)), intensity, 1e-3f) << text << " at " << angle;
  }
}

TEST(IesProfile, MeanIsThatOfAllDirections) {
  EXPECT_NEAR(Profile(Ies("2 1", "0 180  0  7 7")).Mean(), 7, 1e-5f);
  for (const char* file :
       {"2 1|0 90  0  7 3", "3 3|0 50 120  0 45 90  9 5 1  8 4 2  7 3 3",
        "2 4|0 180  0 90 180 270  10 1 20 2 30 3 40 4", "2 3|90 180  90 180 270  1 2 3 4 5 6"}) {
    const std::string text = file;
    const size_t bar = text.find('|');
    const IesProfile profile = Profile(Ies(text.substr(0, bar), text.substr(bar + 1)));
    EXPECT_NEAR(profile.Mean() / MeanByQuadrature(profile), 1, 3e-3f) << text;
  }
}

TEST(IesProfile, ReadsTheVariantsOfTheFormat) {
  const std::string numbers = "1 -1 2 2 1 1 2 0 0 0 .5 1 50 0 180 0 6 6";
  for (const std::string& text : {"TILT=NONE\n" + numbers, "IESNA91\r\n[A] b\r\nTILT=NONE  \r\n" + numbers,
                                  "any text\nTILT=INCLUDE\n1 2 0 90 1 .5\n" + numbers,
                                  std::string("TILT=NONE\n1,-1,2,2,1,1,2,0,0,0,.5,1,50,0,180,0,6,6")}) {
    EXPECT_NEAR(Profile(text).Mean(), 6, 1e-5f) << text;
  }
}

TEST(IesProfile, RefusesWhatItCannotUse) {
  const std::pair<std::string, const char*> cases[] = {
      {"", "line 1: the file has no line \"TILT=\"; expected a photometry file of IES LM-63"},
      {"\x89PNG\n\x1a\n", "line 2: not a photometry file of IES LM-63: it has control characters"},
      {"TILT=lamp.tlt\n1",
       "line 1: expected \"TILT=NONE\" or \"TILT=INCLUDE\"; tilt factors in another file"},
      {"TILT=NONE\n1 2 1 2 1 2 2 0 0 0", "line 2: the photometry is type B; only type C (1) is read"},
      {"TILT=NONE\n1 2 1 2 1 3 2 0 0 0", "line 2: the photometry is type A; only type C (1) is read"},
      {"TILT=NONE\n1 2 x", "line 2: expected the multiplier of candela values, found \"x\""},
      {"TILT=NONE\n1 2 1 1e9 1",
       "line 2: the number of vertical angles must be a whole number from 1 to 3601"},
      {"TILT=NONE\n1 2 1 2.5 1",
       "line 2: the number of vertical angles must be a whole number from 1 to 3601"},
      {Ies("3601 3601", "0"), "line 6: expected vertical angle"},
      {Ies("2 1", "0 0 0 1 1"), "line 6: vertical angles must rise"},
      {Ies("2 1", "0 181 0 1 1"),
       "line 6: vertical angles of type C must be two or more from 0 to 180 degrees"},
      {Ies("2 2", "0 90 10 90 1 1 1 1"),
       "line 6: horizontal angles of type C are one angle, or from 0 to 90"},
      {Ies("2 1", "0 90 0 1 -1"), "line 6: candela values must not be negative"},
      {Ies("2 1", "0 90 0 1 nan"), "line 6: expected a candela value, found \"nan\""},
      {Ies("2 1", "0 90 0 1 1", "-1"),
       "line 5: the multiplier of candela values and the ballast factors must be"},
  };
  for (const auto& [text, message] : cases) {
    const Result<IesProfile> profile = IesProfile::Read(text);
    ASSERT_FALSE(profile) << text;
    EXPECT_TRUE(profile.error().message.starts_with(message) || (text.find("3601 3601") != std::string::npos))
        << text << ": " << profile.error().message;
  }
}

TEST(IesProfile, AnnouncedValuesAreComparedWithTheFileBeforeTheyAreStored) {
  std::string angles;
  for (int i = 0; i < 3601; ++i) angles += fmt::format("{} ", static_cast<float>(i) * 0.05f);
  for (int i = 0; i < 3601; ++i) angles += fmt::format("{} ", static_cast<float>(i) * 0.1f);
  const Result<IesProfile> profile = IesProfile::Read(Ies("3601 3601", angles + "1"));
  ASSERT_FALSE(profile);
  EXPECT_EQ(profile.error().message, "line 6: the file is shorter than the number of its angles announces");
}

TEST(IesLight, ShinesDownWithTheCandelaOfItsFile) {
  LightScene lights;
  lights.files.files["lamp.ies"] = Ies("3 4", "0 90 180  0 90 180 270  100 10 0 100 20 0 100 30 0 100 40 0");
  lights.Build(R"(
    Translate 0 5 0
    LightSource "goniometric" "string filename" "lamp.ies"
    LightSource "goniometric" "string filename" "lamp.ies" "float power" 50 "float scale" 3)");
  ASSERT_EQ(lights.error, "");
  const auto intensity = [&](int light, Vec3 d) {
    return SampleLuminance(lights.table, light, At(Point3{0, 5, 0} + d * 2), {}) * 4;
  };
  EXPECT_NEAR(intensity(0, {0, -1, 0}), 100, 0.5f);
  EXPECT_NEAR(intensity(0, {0, 1, 0}), 0, 0.1f);
  // Counter-clockwise as seen from above.
  EXPECT_NEAR(intensity(0, {1, 0, 0}), 10, 0.1f);
  EXPECT_NEAR(intensity(0, {0, 0, 1}), 20, 0.1f);
  EXPECT_NEAR(intensity(0, {-1, 0, 0}), 30, 0.2f);
  EXPECT_NEAR(intensity(0, {0, 0, -1}), 40, 0.2f);
  // "power" is the luminous flux, which "scale" multiplies as in pbrt.
  const float mean = Profile(lights.files.files["lamp.ies"]).Mean();
  EXPECT_NEAR(intensity(1, {0, -1, 0}), 3 * 100 / mean * 50 / (4 * kPi), 0.05f);
}

}  // namespace
}  // namespace tessera
