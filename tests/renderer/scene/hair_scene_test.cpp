// Pictures of single curves and hairs against closed forms: the area that a curve covers, the light that a
// hair passes on from all directions, and that from one direction.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string_view>

#include "tests/renderer/scene/moving_pictures.h"

namespace tessera::hair_scene {
namespace {

constexpr double kPi = std::numbers::pi;

// All samples have the same wavelengths: quotients of pixels have no noise of colours.
std::string Head(const std::string& maxdepth = "1") {
  return MovingHead("\"path\" \"integer maxdepth\" " + maxdepth, "Option \"disablewavelengthjitter\" true");
}

// ---- Coverage

// The pixels, 1/2 wide, that black curves in front of a uniform sky cover.
double CoveredArea(const std::string& curves) {
  const std::string sky = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
  const std::vector<float> seen =
      GreenOf(Head() + sky + "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n" + curves);
  const double full = static_cast<double>(GreenOf(Head() + sky)[0]);
  double area = 0;
  for (const float value : seen) area += (1 - static_cast<double>(value) / full) / 4;
  return area;
}

TEST(CurvePicture, AStraightCurveCoversItsLengthTimesItsWidth) {
  for (const char* type : {"flat", "cylinder"}) {
    EXPECT_NEAR(CoveredArea("Shape \"curve\" \"string type\" \"" + std::string(type) +
                            "\" \"float width\" 0.07 \"point3 P\" [ -3 -2 5  -1 -1 5  1 0 5  3 1 5 ]"),
                0.07 * std::hypot(6, 3), 0.002)
        << type;
  }
  // Tapered and tilted towards the viewer: its projection counts.
  EXPECT_NEAR(CoveredArea("Shape \"curve\" \"float width0\" 0.3 \"float width1\" 0.1 "
                          "\"point3 P\" [ -3 0 5  -1 0 7  1 0 9  3 0 11 ]"),
              0.2 * 6, 0.003);
}

TEST(CurvePicture, ARibbonCoversItsWidthTimesTheCosineOfItsNormal) {
  EXPECT_NEAR(CoveredArea("Shape \"curve\" \"string type\" \"ribbon\" \"float width\" 0.4 \"normal N\" "
                          "[ 0 0.6 -0.8  0 0.6 -0.8 ] \"point3 P\" [ -3 0 5  -1 0 5  1 0 5  3 0 5 ]"),
              0.4 * 0.8 * 6, 0.005);
}

TEST(CurvePicture, ABentCurveCoversTheLengthOfItsAxisTimesItsWidth) {
  double length = 0;  // of the Bezier curve (-3,-2) (-1,4) (1,-4) (3,2)
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double u = (i + 0.5) / kSteps, v = 1 - u;
    const double dx = 6, dy = 3 * (6 * v * v - 16 * u * v + 6 * u * u);
    length += std::hypot(dx, dy) / kSteps;
  }
  for (const char* type : {"flat", "cylinder"}) {
    EXPECT_NEAR(CoveredArea("Shape \"curve\" \"string type\" \"" + std::string(type) +
                            "\" \"float width\" 0.1 \"point3 P\" [ -3 -2 5  -1 4 5  1 -4 6  3 2 5 ]"),
                0.1 * length, 0.004)
        << type;
  }
}

// ---- Scattering by one hair, after Chiang et al. 2016, in double precision

constexpr double kEta = 1.55, kBeta = 0.3, kAbsorption = 0.3;

double Fresnel(double cosine) {
  const double t = std::sqrt(1 - (1 - cosine * cosine) / (kEta * kEta));
  const double a = (kEta * cosine - t) / (kEta * cosine + t), b = (cosine - kEta * t) / (cosine + kEta * t);
  return (a * a + b * b) / 2;
}

struct Lobes {
  double a[4];     // attenuation
  double gamma_t;  // refracted
};

Lobes LobesAt(double h, double theta_o) {
  const double so = std::sin(theta_o), co = std::cos(theta_o);
  const double sin_gamma_t = h * co / std::sqrt(kEta * kEta - so * so);
  const double T = std::exp(-2 * kAbsorption * std::sqrt(1 - sin_gamma_t * sin_gamma_t) /
                            std::sqrt(1 - so * so / (kEta * kEta)));
  const double f = Fresnel(co * std::sqrt(1 - h * h)), a1 = (1 - f) * (1 - f) * T;
  return {{f, a1, a1 * T * f, a1 * T * f * T * f / (1 - T * f)}, std::asin(sin_gamma_t)};
}

double Longitudinal(double theta_i, double theta_o, double v) {
  const double a = std::cos(theta_i) * std::cos(theta_o) / v;
  return std::exp(-std::sin(theta_i) * std::sin(theta_o) / v) * std::cyl_bessel_i(0.0, a) /
         (2 * v * std::sinh(1 / v));
}

double Azimuthal(double phi, int p, double gamma_o, double gamma_t) {
  const double s = std::sqrt(kPi / 8) * (0.265 * kBeta + 1.194 * kBeta * kBeta);
  const double x = std::abs(std::remainder(phi - (2 * p * gamma_t - 2 * gamma_o + p * kPi), 2 * kPi));
  return std::exp(-x / s) / (s * std::pow(1 + std::exp(-x / s), 2)) / std::tanh(kPi / (2 * s));
}

// The BSDF with the cosine, for hairs whose scales are tilted by 2 degrees.
double Scattering(double h, double theta_o, double theta_i, double phi) {
  const double root = 0.726 * kBeta + 0.812 * kBeta * kBeta, v = root * root, tilt = kPi / 90;
  const Lobes lobes = LobesAt(h, theta_o);
  const double gamma_o = std::asin(h);
  return lobes.a[0] * Longitudinal(theta_i, theta_o - 2 * tilt, v) *
             Azimuthal(phi, 0, gamma_o, lobes.gamma_t) +
         lobes.a[1] * Longitudinal(theta_i, theta_o + tilt, v / 4) *
             Azimuthal(phi, 1, gamma_o, lobes.gamma_t) +
         lobes.a[2] * Longitudinal(theta_i, theta_o + 4 * tilt, 4 * v) *
             Azimuthal(phi, 2, gamma_o, lobes.gamma_t) +
         lobes.a[3] * Longitudinal(theta_i, theta_o, 4 * v) / (2 * kPi);
}

// A hair that fills the picture. It rises at `tilt` away from the viewer.
std::string Hair(double tilt) {
  const double y = 50 * std::cos(tilt), z = 50 * std::sin(tilt);
  return fmt::format(
      "Material \"hair\" \"spectrum sigma_a\" [ 360 {0} 830 {0} ]\nTranslate 0 0 100 Shape \"curve\" "
      "\"string type\" "
      "\"cylinder\" \"float width\" 8 \"point3 P\" [ 0 {1} {2}  0 {3} {4}  0 {5} {6}  0 {7} {8} ]",
      kAbsorption, -y, -z, -y / 3, -z / 3, y / 3, z / 3, y, z);
}

std::vector<double> ColumnMeans(const std::vector<float>& picture) {
  std::vector<double> means(kMovingSize);
  for (size_t i = 0; i < picture.size(); ++i)
    means[i % kMovingSize] += static_cast<double>(picture[i]) / kMovingSize;
  return means;
}

// The mean over a column of a function of where the hair is hit across its width.
template <typename Function>
double ColumnMean(int column, const Function& function) {
  constexpr int kSteps = 400;
  double mean = 0;
  for (int i = 0; i < kSteps; ++i)
    mean += function((column + (i + 0.5) / kSteps) / (kMovingSize / 2) - 1) / kSteps;
  return mean;
}

TEST(HairPicture, UnderAUniformSkyAHairShowsWhatItDoesNotAbsorb) {
  const std::string sky = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
  const double full = static_cast<double>(GreenOf(Head() + sky)[0]);
  for (const double tilt : {0.0, 0.5, -0.9}) {
    const std::vector<double> seen = ColumnMeans(GreenOf(Head("5") + sky + Hair(tilt)));
    for (int column = 0; column < kMovingSize; ++column) {
      const double expected = ColumnMean(column, [&](double h) {
        const Lobes lobes = LobesAt(h, tilt);
        return lobes.a[0] + lobes.a[1] + lobes.a[2] + lobes.a[3];
      });
      EXPECT_NEAR(seen[static_cast<size_t>(column)] / full, expected, 0.01 * expected)
          << tilt << " " << column;
    }
  }
}

// Across the hair the left of the viewer is where h grows: the hair points up, and the normal turns from the
// right, seen from behind, to the left.
TEST(HairPicture, UnderOneLightAHairHasTheRadianceOfItsLobes) {
  struct Light {
    double tilt, theta_i, around;  // the angle of the hair, and those of the light as the hair sees it
  };
  for (const Light& light :
       {Light{0, 0, 0}, Light{0.4, -0.3, 0.8}, Light{-0.3, 0.5, -2}, Light{0.2, 0.1, 3.1}}) {
    const double ct = std::cos(light.tilt), st = std::sin(light.tilt);
    // Along the hair, towards the viewer across it, and to the left across both.
    const double ci = std::cos(light.theta_i), si = std::sin(light.theta_i);
    const double toward = ci * std::cos(light.around), left = ci * std::sin(light.around);
    const double x = -left, y = si * ct + toward * st, z = si * st - toward * ct;
    const auto lit = [&](const std::string& shape) {
      return ColumnMeans(GreenOf(
          Head() +
          fmt::format("LightSource \"distant\" \"point3 from\" [ {} {} {} ] \"point3 to\" [ 0 0 0 ]\n", x, y,
                      z) +
          shape));
    };
    const std::vector<double> seen = lit(Hair(light.tilt));
    // A white wall that the light meets head-on, seen at the angle at which it is.
    const double white =
        ColumnMeans(GreenOf(Head() +
                            "LightSource \"distant\" \"point3 to\" [ 0 0 1 ]\nMaterial \"diffuse\" \"rgb "
                            "reflectance\" [ 1 1 1 ] Shape \"bilinearmesh\" \"point3 P\" "
                            "[ -9 -9 5  9 -9 5  -9 9 5  9 9 5 ]"))[0] *
        kPi;
    for (int column = 0; column < kMovingSize; ++column) {
      const double expected = ColumnMean(
          column, [&](double h) { return Scattering(-h, -light.tilt, light.theta_i, light.around); });
      EXPECT_NEAR(seen[static_cast<size_t>(column)] / white, expected, 0.02 * expected + 0.001)
          << light.tilt << " " << light.theta_i << " " << light.around << " " << column;
    }
  }
}

// ---- Near lights

// The middle of the picture of a band of width 1 at z = 5 in front of the viewer, or of a wall at `wall_z`.
struct Lit {
  std::string light, material;
  double Band() const {
    return Middle("Shape \"curve\" \"float width\" 1 \"point3 P\" [ 0 -9 5  0 -3 5  0 3 5  0 9 5 ]");
  }
  double Wall(double wall_z) const {
    return Middle(
        fmt::format("Shape \"bilinearmesh\" \"point3 P\" [ -9 -9 {0} 9 -9 {0} -9 9 {0} 9 9 {0} ]", wall_z));
  }

 private:
  double Middle(const std::string& shape) const {
    const std::vector<double> columns = ColumnMeans(GreenOf(Head() + light + material + shape));
    return columns[kMovingSize / 2 - 1] + columns[kMovingSize / 2];
  }
};

constexpr std::string_view kPointLight = "LightSource \"point\" \"point3 from\" [ 1.5 0 {} ]\n";
constexpr std::string_view kSphereLight =
    "AttributeBegin Translate 1.5 0 {} AreaLightSource \"diffuse\" Material \"diffuse\" "
    "Shape \"sphere\" \"float radius\" 0.4 AttributeEnd\n";

// Rays leave a curve at the distance of its width.
TEST(CurvePicture, WhatReflectsIsLitWhereRaysLeaveTheCurve) {
  for (const std::string_view light : {kPointLight, kSphereLight}) {
    for (const char* material : {"\"diffuse\"", "\"coateddiffuse\" \"float roughness\" 0.5"}) {
      const Lit lit{fmt::format(fmt::runtime(light), 3), fmt::format("Material {}\n", material)};
      EXPECT_NEAR(lit.Band(), lit.Wall(4), 0.01 * lit.Wall(4)) << light << material;
    }
  }
}

TEST(CurvePicture, WhatTransmitsIsLitBehindTheCurve) {
  for (const std::string_view light : {kPointLight, kSphereLight}) {
    const Lit lit{fmt::format(fmt::runtime(light), 7),
                  "Material \"diffusetransmission\" \"rgb reflectance\" [ 0 0 0 ]\n"};
    EXPECT_NEAR(lit.Band(), lit.Wall(6), 0.01 * lit.Wall(6)) << light;
  }
}

TEST(CurvePicture, WhatReflectsAndTransmitsIsLitAtTheAxis) {
  const Lit lit{fmt::format(fmt::runtime(kPointLight), 3), "Material \"diffusetransmission\"\n"};
  EXPECT_NEAR(lit.Band(), lit.Wall(5), 0.01 * lit.Wall(5));
}

}  // namespace
}  // namespace tessera::hair_scene
