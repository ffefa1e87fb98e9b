// Pictures of media against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/renderer/scene/media_scenes.h"

namespace tessera::media_scenes {
namespace {

// Beer-Lambert law through the middle of the ball, over a length of 2; nothing is random.
TEST(Media, AbsorptionAlongACameraRayIsTheClosedFormWithoutNoise) {
  const std::string head = Narrow(kVolPath) + "WorldBegin\n" + kEvenLight;
  const std::string ball = Medium("m", 0.7, 0) + Ball("\"interface\"", "m");
  ExpectEverywhere(Render(head + ball, 4), Render(head, 4), std::exp(-0.7 * 2), 1e-3);
}

// Light from beside the camera passes through the ball into a larger one around the lit plane.
TEST(Media, SampledLightIsAttenuatedByAllMediaAlongTheShadowRay) {
  const std::string head = Narrow(kVolPath) + "WorldBegin\n" + kDistantLight, plane = R"(
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.6 ]
MediumInterface "n" "n"
Shape "disk" "float height" 8 "float radius" 1.5
)";
  const std::string media = Medium("m", 0.2, 0) + Medium("n", 0.5, 0);
  const std::string balls = Ball("\"interface\"", "m") + R"(
AttributeBegin
MediumInterface "n" ""
Material "interface"
Translate 0 0 8
Shape "sphere" "float radius" 2
AttributeEnd
)";
  // To the plane and back: a length of 2 in each.
  const double factor = std::exp(-2 * (0.2 * 2 + 0.5 * 2));
  ExpectEverywhere(Render(head + media + balls + plane, 4), Render(head + media + plane, 4), factor, 1e-3);
}

TEST(Media, CameraCanBeInsideAMedium) {
  const std::string wall = R"(
AttributeBegin
ReverseOrientation
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "sphere" "float radius" 1.5
AttributeEnd
)";
  const std::string head = Wide(kVolPath) + "WorldBegin\n";
  const std::string medium = Medium("m", 1, 0) + "MediumInterface \"\" \"m\"\n";
  ExpectEverywhere(Render(medium + head + wall, 4), Render(head + wall, 4), std::exp(-1.5), 1e-3);
}

// A ball that absorbs and glows, seen from outside: Le (1 - exp(-sigma_a d)).
TEST(Media, EmissionOfAnAbsorbingBallIsTheClosedFormWithoutNoise) {
  const std::string head = Narrow(kVolPath) + "WorldBegin\n";
  const std::string ball = Medium("m", 0.4, 0, "\"rgb Le\" [ 3 3 3 ]") + Ball("\"interface\"", "m");
  ExpectEverywhere(Render(head + ball, 16), Render(head + kEvenLight, 16), 3 * (1 - std::exp(-0.4 * 2)),
                   1e-3);
}

TEST(Media, EmissiveMediumCountsAsALightSource) {
  const std::string ball = Medium("m", 0.4, 0, "\"rgb Le\" [ 3 3 3 ]") + Ball("\"interface\"", "m");
  const auto scene = LoadMedia(Narrow(kVolPath) + "WorldBegin\n" + ball);
  ASSERT_TRUE(scene);
  EXPECT_TRUE((*scene)->summary().warnings.empty());
}

// In uniform light a medium that absorbs nothing is invisible: each path finds exactly that light.
TEST(Media, ScatteringAloneIsInvisibleInAWhiteFurnace) {
  const std::string head = Wide(kVolPath) + "WorldBegin\n" + kEvenLight;
  const Pixels furnace = Render(head, 16);
  for (const char* g : {"-0.6", "0", "0.9"}) {
    const std::string ball = Medium("m", 0, 5, "\"float g\" " + std::string(g)) + Ball("\"interface\"", "m");
    ExpectEverywhere(Render(head + ball, 16), furnace, 1, 1e-4);
  }
}

// In an oven of uniform temperature everything has the same radiance: a medium emits what it absorbs. This
// covers all of the transport: chromatic scattering weights wavelengths against each other, light sampling
// and rays find the wall, glass refracts and disperses.
constexpr const char* kOven = R"(
AttributeBegin
ReverseOrientation
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "sphere" "float radius" 9
AttributeEnd
)";

struct OvenContent {
  const char *sigma_a, *radiance;  // in a medium of index n the radiance of a black body is n^2 times as high
  std::string bodies;
  double tolerance = 0.012;
};

TEST(Media, IsothermalOvenHasUniformRadiance) {
  const std::string head = Wide(kVolPath) + "WorldBegin\n" + kOven;
  const std::string glass = "\"dielectric\" \"float eta\" 1.5";
  // Wavelengths are weighted against each other in the fog; one remains after dispersive glass.
  const std::string prism_in_fog =
      Ball("\"interface\"", "m", 3.5) + Ball("\"dielectric\" \"spectrum eta\" \"glass-F11\"", "", 1.5);
  const Pixels oven = Render(head, 256);
  for (const auto& [sigma_a, radiance, bodies, tolerance] : std::initializer_list<OvenContent>{
           {"0 0 0", "0 0 0", Ball("\"interface\"", "m")},
           {"0.1 0.6 0.3", "1 1 1", Ball("\"interface\"", "m")},
           {"5 0.01 1", "1 1 1", Ball("\"interface\"", "m")},
           {"0.1 0.6 0.3", "1 1 1", Ball("\"thindielectric\"", "m")},
           {"0 0 0", "0 0 0", Ball(glass, "m")},
           {"5 0.01 1", "2.25 2.25 2.25", Ball(glass, "m")},
           {"0 0 0", "0 0 0", prism_in_fog, 0.03},
       }) {
    const std::string medium =
        R"(MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_s" [ 0.2 0.8 3 ] "float g" 0.4)" +
        std::string(" \"rgb sigma_a\" [ ") + sigma_a + " ] \"rgb Le\" [ " + radiance + " ]\n";
    ExpectMean(Render(head + medium + bodies, 256), oven, 1, tolerance, bodies + sigma_a);
  }
}

// On the axis of the camera.
constexpr const char* kPointLight = "LightSource \"point\" \"point3 from\" [ 0 0 2 ]\n";
constexpr const char* kLamp = R"(
AttributeBegin
AreaLightSource "diffuse"
Translate 0 1 5
Shape "sphere" "float radius" 0.01
AttributeEnd
)";

// Untrusted scenes contain such numbers. They must not lead to a ray that cannot be traced or a pixel that is
// NaN.
TEST(Media, UnboundedMediaOfExtremeCoefficientsGiveFinitePixels) {
  for (const char* value : {"0", "1e-30", "1e-12", "1e10", "1e19"}) {
    for (const char* g : {"-1", "1"}) {
      const std::string v = value;
      SCOPED_TRACE(v + " " + g);
      const std::string medium =
          "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0 " + v +
          " 0 ] \"rgb sigma_s\" [ " + v + " 0 " + v + " ] \"rgb Le\" [ 1 2 3 ] \"float g\" " + g +
          "\nMediumInterface \"m\"\n";
      std::string head = Wide(kVolPath);
      head.replace(head.find("1000"), 4, "30");
      for (const char* light : {kDistantLight, kPointLight}) {
        (void)Render(medium + head + "WorldBegin\n" + kEvenLight + light + Ball("\"diffuse\"", "m"), 8);
        (void)Render(medium + head + "WorldBegin\n" + light + kLamp, 8);
      }
    }
  }
}

// Light along +z into a slab from z = 1 to 2, seen from where it comes: the integral of singly scattered
// light over depth s, sigma_s p(-1) E exp(-2 sigma_t s).
TEST(Media, SingleScatteringOfASlabIsTheClosedForm) {
  const double sigma_s = 0.8, sigma_t = 1.1, g = 0.3;
  std::string head = Narrow(kVolPath);
  head.replace(head.find("1000"), 4, "1");
  const std::string slab = Medium("m", sigma_t - sigma_s, sigma_s, "\"float g\" 0.3") + R"(
MediumInterface "m" ""
Material "interface"
Shape "bilinearmesh" "point3 P" [ -40 -40 2  40 -40 2  -40 40 2  40 40 2 ]
ReverseOrientation
Shape "bilinearmesh" "point3 P" [ -40 -40 1  40 -40 1  -40 40 1  40 40 1 ]
)";
  const double back = (1 - g * g) / (4 * M_PI * std::pow(1 + g, 3));
  const double expected = sigma_s * back * 2 * (1 - std::exp(-2 * sigma_t)) / (2 * sigma_t);
  const Pixels picture = Render(head + "WorldBegin\n" + kDistantLight + slab, 2048);
  ExpectMean(picture, Render(head + "WorldBegin\n" + kEvenLight, 2048), expected, 0.015);
}

constexpr double kPointScattering = 0.3, kPointAbsorption = 0.1, kPointDistance = 0.03;

// A fog in which rays along +z pass a point light of intensity 10 at z = 3. Light is scattered once.
std::string FogAroundAPointLight(const std::string& behind) {
  std::string head = Narrow(kVolPath);
  head.replace(head.find("1000"), 4, "1").replace(head.find("fov\" 0.5"), 8, "fov\" 0.01");
  head.insert(head.find("Camera"), Medium("m", kPointAbsorption, kPointScattering, "\"float g\" 0.3") +
                                       "MediumInterface \"\" \"m\"\n");
  return head + "WorldBegin\nLightSource \"point\" \"rgb I\" [ 10 10 10 ] \"point3 from\" [ " +
         std::to_string(kPointDistance) + " 0 3 ]\n" + behind;
}

// Of the radiance along the rays up to z, by the midpoint rule over the angle at the light.
double PointLightScatteredUpTo(double z) {
  constexpr int kSteps = 100000;
  const double g = 0.3, extinction = kPointAbsorption + kPointScattering;
  const double first = std::atan(-3 / kPointDistance), last = std::atan((z - 3) / kPointDistance);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = first + (i + 0.5) * (last - first) / kSteps;
    const double along = kPointDistance * std::tan(angle), distance = std::hypot(along, kPointDistance);
    // Light goes away from the point light, and on against the ray.
    const double cosine = -along / distance;
    const double phase = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * cosine, 1.5));
    sum += phase * std::exp(-extinction * (3 + along + distance));
  }
  return 10 * kPointScattering * sum * (last - first) / kSteps / kPointDistance;
}

TEST(Media, LightOfAPointLightCloseToTheRayIsTheIntegralOverTheRay) {
  // A small disk before the light hides the end of the ray from it, too.
  struct Disk {
    double z, radius, lit_up_to;
  };
  const Pixels even = Render(Narrow(kVolPath) + "WorldBegin\n" + kEvenLight, 1024);
  for (const auto& [z, radius, lit_up_to] :
       {Disk{2.99, 0.003, 2.98889}, Disk{3.1, 9, 3.1}, Disk{12, 9, 12}, Disk{1e4, 1, 1e4}}) {
    const std::string disk =
        "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\nShape \"disk\" \"float height\" " +
        std::to_string(z) + " \"float radius\" " + std::to_string(radius);
    ExpectMean(Render(FogAroundAPointLight(disk), 1024), even, PointLightScatteredUpTo(lit_up_to), 0.01,
               std::to_string(z));
  }
}

// Collisions alone would find most of it in few samples of great weight: the relative variance of one sample
// would be about 30.
TEST(Media, LightOfAPointLightCloseToTheRayHasLittleNoise) {
  constexpr uint32_t kSamples = 16;
  const Pixels picture = Render(FogAroundAPointLight(""), kSamples);
  const double mean = picture.Mean(1);
  double sum = 0;
  for (size_t i = 0; i < 64; ++i) sum += std::pow(picture.values[i * 3 + 1] - mean, 2);
  EXPECT_LT(sum / 63 * kSamples / (mean * mean), 1.5);
}

// A surface with the same medium on both sides is not a boundary: rays keep their medium.
TEST(Media, SurfaceWithTheSameMediumOnBothSidesChangesNothing) {
  const std::string body = R"(
AttributeBegin
MediumInterface "n" "n"
Translate 0 0 4
Material "interface"
Shape "sphere" "float radius" 0.5
AttributeEnd
)";
  const std::string head = Narrow(kVolPath) + "WorldBegin\n" + kEvenLight;
  const std::string media = Medium("m", 0.7, 0) + Medium("n", 9, 0);
  ExpectEverywhere(Render(head + media + Ball("\"interface\"", "m") + body, 4), Render(head, 4),
                   std::exp(-0.7 * 2), 1e-3);
}

constexpr const char* kRoom = R"(
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
LightSource "point" "point3 from" [ 1 2 1 ] "rgb I" [ 8 8 8 ]
MakeNamedMedium "m" "string type" "homogeneous" "string preset" "Skin1" "float scale" 2 "float g" 0.5
Material "diffuse" "rgb reflectance" [ 0.7 0.5 0.3 ]
Shape "bilinearmesh" "point3 P" [ -5 -1 0  5 -1 0  -5 -1 9  5 -1 9 ]
AttributeBegin
MediumInterface "m" ""
Translate 0 0 4
Material "dielectric" "spectrum eta" "glass-BK7" "float roughness" 0.1
Shape "sphere"
AttributeEnd
)";

TEST(Media, UnitRenderedTwiceHasTheSameBits) {
  const std::string text = Wide(kVolPath) + "WorldBegin\n" + kRoom;
  const auto first = LoadMedia(text), second = LoadMedia(text);
  ASSERT_TRUE(first && second);
  const RadianceTile expected = *(*first)->Render({2, 1, 7, 8}, {}, {8, 8}, nullptr);
  (void)(*second)->Render({0, 0, 8, 8}, {}, {0, 4}, nullptr);
  EXPECT_EQ(*(*second)->Render({2, 1, 7, 8}, {}, {8, 8}, nullptr), expected);
}

std::string Without(std::string text, const std::string& part) {
  return text.replace(text.find(part), part.size(), "");
}

TEST(Media, VolpathAndPathGiveTheSameBitsWithoutMedia) {
  RenderOptions path;
  path.integrator = "path";
  // Defined, but no ray can be in it.
  const std::string text = Without(Wide(kVolPath) + "WorldBegin\n" + kRoom, "MediumInterface \"m\" \"\"");
  EXPECT_EQ(Sums(text, 16), Sums(text, 16, path));
}

TEST(Media, PathIgnoresMedia) {
  RenderOptions path;
  path.integrator = "path";
  const std::string text = Wide(kVolPath) + "WorldBegin\n" + kRoom;
  const std::vector<float> ignored = Sums(text, 16, path);
  EXPECT_EQ(ignored, Sums(Without(text, "MediumInterface \"m\" \"\""), 16, path));
  EXPECT_NE(ignored, Sums(text, 16));
}

}  // namespace
}  // namespace tessera::media_scenes
