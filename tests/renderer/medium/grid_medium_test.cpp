// Media on grids against quadrature along rays.
#include "renderer/medium/grid_medium.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "renderer/color/named_spectra.h"
#include "renderer/medium/flight.h"
#include "renderer/medium/medium.h"
#include "tests/chi_square.h"
#include "tests/renderer/medium/built_media.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const SampledWavelengths kGridWavelengths = SampledWavelengths::SampleVisible(0.3f);

// Numbers between 0 and 2, most of them 0, for a grid.
std::string Densities(int count, uint64_t seed) {
  TestRandom random(seed);
  std::string text;
  for (int i = 0; i < count; ++i) {
    const float u = random.Next();
    text += (u < 0.4f ? std::to_string(5 * u) : std::string("0")) + " ";
  }
  return text;
}
constexpr const char* kSize = "\"integer nx\" 9 \"integer ny\" 4 \"integer nz\" 5 ";
constexpr const char* kPlace = "\"point3 p0\" [ -1 0 2 ] \"point3 p1\" [ 2 -1 3 ] ";

// All kinds of media that vary, transformed.
std::vector<BuiltMedia> VaryingMedia() {
  const std::string transform = "Rotate 30 1 2 3 Scale 2 3 -1 ";
  std::vector<BuiltMedia> media;
  media.push_back(BuildMedia(transform + "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" " + kSize +
                             kPlace + "\"float density\" [ " + Densities(180, 1) +
                             "] \"rgb sigma_a\" [ 0.1 0.7 2 ] \"rgb sigma_s\" [ 1 0.2 0 ] \"float scale\" 2 "
                             "\"rgb Le\" [ 1 2 3 ] \"float Lescale\" [ " +
                             Densities(180, 2) + "]"));
  media.push_back(BuildMedia(transform + "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" " + kSize +
                             kPlace + "\"rgb sigma_a\" [ " + Densities(540, 3) + "] \"rgb sigma_s\" [ " +
                             Densities(540, 4) + "] \"float scale\" 1.5 \"rgb Le\" [ " + Densities(540, 5) +
                             "]"));
  media.push_back(BuildMedia(transform +
                             "MakeNamedMedium \"m\" \"string type\" \"cloud\" \"float density\" 2 "
                             "\"rgb sigma_s\" [ 3 3 3 ] \"point3 p1\" [ 1 1.25 1 ]"));
  return media;
}

// Rays through the boxes of the media.
std::vector<Ray> RaysThroughMedia(int count) {
  TestRandom random(7);
  const auto signed_number = [&](float size) { return size * (2 * random.Next() - 1); };
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Ray ray;
    ray.o = {signed_number(6), signed_number(6), signed_number(6)};
    ray.d = Vec3{signed_number(3), signed_number(3), signed_number(3)} - ray.o;
    ray.d = ray.d / Length(ray.d);
    if (i % 4 == 0) ray.d = {i % 8 == 0 ? 1.0f : 0.0f, 0, i % 8 == 0 ? 0.0f : -1.0f};
    rays.push_back(ray);
  }
  return rays;
}

// The same four wavelengths, of which another is the first in each turn.
SampledWavelengths Turn(int turn) {
  return SampledWavelengths::SampleVisible(0.05f + 0.25f * static_cast<float>(turn));
}

// Whether the point of a ray is in the box of the grid.
template <typename Coefficients>
bool IsInBox(const Coefficients& coefficients, Point3 p) {
  if constexpr (requires { coefficients.placement(); })
    return coefficients.placement().box().Contains(coefficients.placement().PositionOf(p));
  return true;
}

// Returns how many points of the ray are in the medium.
template <typename Coefficients>
int CheckMajorants(const Coefficients& coefficients, const Ray& ray) {
  auto medium = coefficients.RayAlong(ray);
  int points = 0;
  float t = 0;
  MajorantSegment segment;
  while (medium.Next(&segment)) {
    EXPECT_GE(segment.t_end, t);
    EXPECT_LT(segment.t_end, 100);
    constexpr int kPoints = 16;
    for (int i = 0; i < kPoints; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / kPoints, at = t + (segment.t_end - t) * u;
      if (!IsInBox(coefficients, ray.At(at))) continue;
      const MediumPoint point = medium.At(at);
      for (int w = 0; w < 4; ++w) {
        EXPECT_LE((point.sigma_a + point.sigma_s)[w], segment.sigma_maj[w] * (1 + 1e-5f) + 1e-6f);
        EXPECT_GE(point.sigma_a[w], 0);
        EXPECT_GE(point.sigma_s[w], 0);
      }
      points += AnyNonZero(point.sigma_a + point.sigma_s) ? 1 : 0;
    }
    t = segment.t_end;
  }
  return points;
}

TEST(GridMedia, MajorantsBoundTheDensityEverywhere) {
  for (const BuiltMedia& built : VaryingMedia()) {
    ASSERT_EQ(built.error, "");
    const MediumCoefficients coefficients = built.table[0].At(kGridWavelengths);
    int points = 0;
    for (const Ray& ray : RaysThroughMedia(400))
      points += Dispatch(coefficients, [&](const auto& kind) { return CheckMajorants(kind, ray); });
    EXPECT_GT(points, 2000);
  }
}

// At four wavelengths.
using FourSums = std::array<double, 4>;

struct RayIntegrals {
  FourSums transmittance{}, emitted{}, scattered{}, shadow{};
};

// By the midpoint rule in each stretch.
template <typename Coefficients>
RayIntegrals Quadrature(const Coefficients& coefficients, const Ray& ray) {
  auto medium = coefficients.RayAlong(ray);
  RayIntegrals result;
  FourSums depth{};
  double t = 0;
  MajorantSegment segment;
  while (medium.Next(&segment)) {
    if (!AnyNonZero(segment.sigma_maj)) {
      t = static_cast<double>(segment.t_end);
      continue;
    }
    constexpr int kSteps = 64;
    const double dt = (static_cast<double>(segment.t_end) - t) / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const MediumPoint point = medium.At(static_cast<float>(t + (i + 0.5) * dt));
      for (int w = 0; w < 4; ++w) {
        const double step = static_cast<double>(point.sigma_a[w] + point.sigma_s[w]) * dt;
        const double transmittance = std::exp(-(depth[w] + step / 2));
        result.emitted[w] += transmittance * static_cast<double>(point.emission[w]) * dt;
        result.scattered[w] += transmittance * static_cast<double>(point.sigma_s[w]) * dt;
        depth[w] += step;
      }
    }
    t = static_cast<double>(segment.t_end);
  }
  for (int w = 0; w < 4; ++w) result.transmittance[w] = result.shadow[w] = std::exp(-depth[w]);
  return result;
}

constexpr int kFlightsPerTurn = 8000;

// Adds the flights in which wavelength `turn` of the first turn decides.
template <typename Coefficients>
void AddFlights(const Coefficients& coefficients, const Ray& ray, int turn, RayIntegrals* sums) {
  const auto add = [&](SampledSpectrum value, FourSums* sum) {
    for (int w = 0; w < 4; ++w)
      (*sum)[(w + turn) % 4] += static_cast<double>(value[w]) / (4 * kFlightsPerTurn);
  };
  TestRandom random(static_cast<uint64_t>(turn) + 1);
  for (int i = 0; i < kFlightsPerTurn; ++i) {
    const Ray seed{{static_cast<float>(i), 0, 0}, {0, 0, static_cast<float>(turn)}};
    FlightRandom numbers(seed, random.Next()), shadow_numbers(seed);
    PathWeights path, passage;
    SampledSpectrum emitted;
    float t = 0;
    const FlightEnd end = Fly(coefficients.RayAlong(ray), 100, numbers, &path, &emitted, &t);
    add(emitted, &sums->emitted);
    if (end == FlightEnd::kPassed) add(path.Throughput(), &sums->transmittance);
    if (end == FlightEnd::kScattered) add(path.Throughput(), &sums->scattered);
    FlyShadow(coefficients.RayAlong(ray), 100, shadow_numbers, &passage);
    add(passage.beta / Average(passage.r_l), &sums->shadow);
  }
}

TEST(GridMedia, FlightsAndShadowRaysHaveTheMeansOfQuadrature) {
  for (const BuiltMedia& built : VaryingMedia()) {
    ASSERT_EQ(built.error, "");
    for (const Ray& ray : RaysThroughMedia(10)) {
      const MediumCoefficients first = built.table[0].At(Turn(0));
      const RayIntegrals expected = Dispatch(first, [&](const auto& kind) { return Quadrature(kind, ray); });
      RayIntegrals found;
      for (int turn = 0; turn < 4; ++turn) {
        const MediumCoefficients turned = built.table[0].At(Turn(turn));
        Dispatch(turned, [&](const auto& kind) { AddFlights(kind, ray, turn, &found); });
      }
      for (int w = 0; w < 4; ++w) {
        EXPECT_NEAR(found.transmittance[w], expected.transmittance[w], 0.02) << w;
        EXPECT_NEAR(found.shadow[w], expected.shadow[w], 0.02) << w;
        EXPECT_NEAR(found.scattered[w], expected.scattered[w], 0.02) << w;
        EXPECT_NEAR(found.emitted[w], expected.emitted[w], 0.02 + 0.05 * expected.emitted[w]) << w;
      }
    }
  }
}

// Beside one dense voxel lie empty ones under the same bound, where every collision is null. So far from the
// start of the ray, the steps between them are smaller than the spacing of floats.
TEST(GridMedia, FlightsThroughEmptyPartsOfDenseCellsEnd) {
  std::string densities = "1 ";
  for (int i = 1; i < 200; ++i) densities += "0 ";
  const BuiltMedia built = BuildMedia(
      "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 200 \"float density\" [ " +
      densities + "] \"spectrum sigma_s\" [ 300 1e5 900 1e5 ] \"spectrum sigma_a\" [ 300 0 900 0 ]");
  ASSERT_EQ(built.error, "");
  const MediumCoefficients at = built.table[0].At(kGridWavelengths);
  const auto& coefficients = std::get<GridCoefficients>(at);
  const Ray ray{{0.0125f, -1e4f, 0.5f}, {0, 1, 0}};  // through the third voxel
  MajorantSegment segment;
  auto medium = coefficients.RayAlong(ray);
  ASSERT_TRUE(medium.Next(&segment) && medium.Next(&segment));
  ASSERT_GT(segment.sigma_maj[0], 9e4f);
  for (int i = 0; i < 10; ++i) {
    const Ray seed{{static_cast<float>(i), 0, 0}, {0, 0, 1}};
    FlightRandom numbers(seed), shadow_numbers(seed);
    PathWeights path, passage;
    float t = 0;
    EXPECT_EQ(Fly(coefficients.RayAlong(ray), 2e4f, numbers, &path, nullptr, &t), FlightEnd::kPassed);
    FlyShadow(coefficients.RayAlong(ray), 2e4f, shadow_numbers, &passage);
    EXPECT_NEAR(passage.beta[0] / passage.r_l[0], 1, 1e-3);
  }
}

TEST(GridMedia, DensityIsInterpolatedBetweenTheCentresOfVoxels) {
  const BuiltMedia built = BuildMedia(
      "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ 1 3 ] "
      "\"spectrum sigma_a\" [ 300 1 900 1 ] \"spectrum sigma_s\" [ 300 0 900 0 ] \"point3 p1\" [ 4 1 1 ]");
  ASSERT_EQ(built.error, "");
  const auto coefficients = std::get<GridCoefficients>(built.table[0].At(kGridWavelengths));
  const Ray ray{{-1, 0.5f, 0.5f}, {1, 0, 0}};
  const auto at = [&](float x) { return coefficients.RayAlong(ray).At(x + 1).sigma_a[0]; };
  EXPECT_NEAR(at(1), 1, 1e-5);
  EXPECT_NEAR(at(2), 2, 1e-5);
  EXPECT_NEAR(at(3), 3, 1e-5);
  // Beyond the outer centres it falls off towards zero one voxel further, and is cut at the surface.
  EXPECT_NEAR(at(0.001f), 0.5, 3e-3);
  EXPECT_NEAR(at(3.999f), 1.5, 3e-3);
}

// Two voxels of different temperature: at their centres the emission is that of black bodies.
TEST(GridMedia, TemperatureBecomesTheEmissionOfABlackBody) {
  const BuiltMedia built = BuildMedia(
      "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ 2 2 ] "
      "\"float temperature\" [ 2000 150 ] \"float temperatureoffset\" 100 \"float temperaturescale\" 2 "
      "\"float Lescale\" [ 3 3 ] \"point3 p1\" [ 2 1 1 ]");
  ASSERT_EQ(built.error, "");
  EXPECT_TRUE(built.table[0].is_emissive());
  const auto coefficients = std::get<GridCoefficients>(built.table[0].At(kGridWavelengths));
  const Ray ray{{0, 0.5f, 0.5f}, {1, 0, 0}};
  const MediumPoint hot = coefficients.RayAlong(ray).At(0.5f), cold = coefficients.RayAlong(ray).At(1.5f);
  const auto planck = Blackbody(3800);
  const SampledSpectrum expected = SampleTable(*planck, kGridWavelengths) * (3.0f * 2);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(hot.emission[i] / expected[i], 1, 5e-3);
    EXPECT_EQ(cold.emission[i], 0);  // exactly 100 kelvin
  }
}

TEST(GridMedia, DispersionLeavesTheFirstWavelengthAlone) {
  SampledWavelengths dropped = kGridWavelengths;
  dropped.TerminateSecondary();
  for (const BuiltMedia& built : VaryingMedia()) {
    const MediumCoefficients all = built.table[0].At(kGridWavelengths), one = built.table[0].At(dropped);
    const Ray ray{{0, 0, 0}, {0, 1, 0}};
    const auto points = [&](const MediumCoefficients& coefficients) {
      return Dispatch(coefficients, [&](const auto& kind) {
        auto medium = kind.RayAlong(ray);
        std::vector<MediumPoint> found;
        for (float t = 0; t < 6; t += 0.1f) found.push_back(medium.At(t));
        return found;
      });
    };
    const std::vector<MediumPoint> before = points(all), after = points(one);
    for (size_t i = 0; i < before.size(); ++i) {
      for (int w = 0; w < 4; ++w) {
        EXPECT_EQ(after[i].sigma_a[w], before[i].sigma_a[0]);
        EXPECT_EQ(after[i].sigma_s[w], before[i].sigma_s[0]);
        EXPECT_EQ(after[i].emission[w], before[i].emission[0]);
      }
    }
  }
}

struct BadGrid {
  std::string parameters, message;
};

std::string GridError(const std::string& kind, const std::string& parameters) {
  return BuildMedia("MakeNamedMedium \"m\" \"string type\" \"" + kind + "\" " + parameters).error;
}

TEST(GridMedia, HostileGridsAreRefusedWithTheirPlace) {
  const std::string one = "\"float density\" 1 ";
  for (const auto& [parameters, message] : std::vector<BadGrid>{
           {"", "m.pbrt:3:1: uniformgrid needs a density"},
           {"\"float density\" [ 1 2 3 ] \"integer nx\" 2",
            "density has 3 values, expected nx * ny * nz = 2 * 1 * 1 = 2"},
           {one + "\"integer nx\" 0", "nx must lie between 1 and 65536, not 0"},
           {one + "\"integer ny\" -4", "ny must lie between 1 and 65536, not -4"},
           {one + "\"integer nz\" 2147483647", "nz must lie between 1 and 65536, not 2147483647"},
           {one + "\"integer nx\" 65536 \"integer ny\" 65536 \"integer nz\" 65536", "= 281474976710656"},
           {"\"float density\" [ 1 -0.5 ] \"integer ny\" 2", "density has the value -0.5 at (0, 1, 0)"},
           {one + "\"float temperature\" [ 1 2 ]", "temperature has 2 values"},
           {one + "\"float Lescale\" [ 1 2 ]", "Lescale has 2 values"},
           {one + "\"float Lescale\" -1", "Lescale has the value -1 at (0, 0, 0)"},
           {one + "\"float temperature\" 900 \"rgb Le\" [ 1 1 1 ]", "Le and temperature exclude each other"},
           {one + "\"point3 p1\" [ 1 0 1 ]", "p0 and p1 must be corners of a box"},
           {one + "\"point3 p0\" [ -3e38 0 0 ] \"point3 p1\" [ 3e38 1 1 ]",
            "p0 and p1 must be corners of a box"},
           {one + "\"float scale\" -1", "scale must not be negative"},
           {"\"float density\" 1e15 \"float scale\" 1e10", "sigma_a is too large"},
           {"\"float density\" 1e4 \"float scale\" 1e3",
            "the medium is too dense: up to 3.46e+07 mean free paths"},
           {one + "\"float g\" 2", "g must lie between -1 and 1"},
           {one + "\"string preset\" \"Apple\"", "unknown parameter \"string preset\""},
       }) {
    EXPECT_THAT(GridError("uniformgrid", parameters), HasSubstr(message)) << parameters;
    EXPECT_THAT(GridError("uniformgrid", parameters), testing::StartsWith("m.pbrt:3:")) << parameters;
  }
  const std::string red = "\"rgb sigma_a\" [ 1 0 0 ] ";
  for (const auto& [parameters, message] : std::vector<BadGrid>{
           {"", "m.pbrt:3:1: rgbgrid needs sigma_a or sigma_s"},
           {red + "\"integer nx\" 2", "sigma_a has 1 colours, expected nx * ny * nz = 2 * 1 * 1 = 2"},
           {"\"rgb sigma_a\" [ 1 0 ]", "expected a multiple of 3"},
           {"\"rgb sigma_s\" [ 1 -1 0 ]", "sigma_s has the component -1 at (0, 0, 0)"},
           {"\"rgb sigma_s\" [ 1 1 1 ] \"rgb Le\" [ 1 1 1 ]", "Le needs sigma_a"},
           {"\"rgb sigma_s\" [ 1e20 0 0 ] \"float scale\" 10", "the coefficients are too large"},
       }) {
    EXPECT_THAT(GridError("rgbgrid", parameters), HasSubstr(message)) << parameters;
  }
  EXPECT_THAT(GridError("cloud", "\"float density\" -1"), HasSubstr("density must not be negative"));
  EXPECT_THAT(GridError("cloud", "\"rgb sigma_s\" [ 1e9 0 0 ]"), HasSubstr("the medium is too dense"));
  EXPECT_THAT(GridError("cloud", "\"point3 p1\" [ 0 1 1 ]"), HasSubstr("p0 and p1 must be corners of a box"));
}

// A voxel grid of a few values along one axis takes little memory, and one of zeros none.
TEST(VoxelGrid, ReturnsWhatWasSetAndZeroAround) {
  FloatGrid grid({20, 3, 9});
  TestRandom random(5);
  std::vector<std::array<int, 3>> voxels;
  for (int i = 0; i < 100; ++i) {
    const std::array<int, 3> v{static_cast<int>(random.Next() * 20), static_cast<int>(random.Next() * 3),
                               static_cast<int>(random.Next() * 9)};
    grid.Set(v[0], v[1], v[2], static_cast<float>(v[0] + 100 * v[1] + 1000 * v[2] + 1));
    voxels.push_back(v);
  }
  for (const auto& v : voxels) {
    const Point3 at{static_cast<float>(v[0] + 1), static_cast<float>(v[1] + 1), static_cast<float>(v[2] + 1)};
    EXPECT_EQ(grid.Lookup(at), static_cast<float>(v[0] + 100 * v[1] + 1000 * v[2] + 1));
    EXPECT_EQ(grid.Lookup({0, at.y, at.z}), 0);
    EXPECT_EQ(grid.Lookup({at.x, 4, at.z}), 0);
    EXPECT_EQ(grid.Lookup({at.x, at.y, 10}), 0);
  }
  FloatGrid line({1, 1, 100});
  line.Set(0, 0, 7, 2);
  line.Set(0, 0, 8, 4);
  EXPECT_FLOAT_EQ(line.Lookup({1, 1, 8.25f}), 2.5f);
  EXPECT_FLOAT_EQ(line.Lookup({0.5f, 1, 8}), 1);
}

TEST(VoxelGrid, FillingABoxEqualsSettingItsVoxels) {
  const GridSize size{20, 3, 9};
  TestRandom random(6);
  FloatGrid filled(size), set(size);
  for (int i = 0; i < 40; ++i) {
    GridSize begin{}, end{};
    for (size_t axis = 0; axis < 3; ++axis) {
      begin[axis] = static_cast<int>(random.Next() * static_cast<float>(size[axis]));
      end[axis] =
          begin[axis] + 1 + static_cast<int>(random.Next() * static_cast<float>(size[axis] - begin[axis]));
    }
    const float value = i % 8 == 7 ? 0 : static_cast<float>(i + 1);
    filled.Fill(begin, end, value);
    for (int x = begin[0]; x < end[0]; ++x) {
      for (int y = begin[1]; y < end[1]; ++y) {
        for (int z = begin[2]; z < end[2]; ++z) set.Set(x, y, z, value);
      }
    }
    for (int probe = 0; probe < 300; ++probe) {
      const Point3 at{random.Next() * 21, random.Next() * 4, random.Next() * 10};
      ASSERT_EQ(filled.Lookup(at), set.Lookup(at)) << i << " at " << at.x << " " << at.y << " " << at.z;
    }
  }
}

}  // namespace
}  // namespace tessera
