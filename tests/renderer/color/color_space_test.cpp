#include "renderer/color/color_space.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "renderer/color/named_spectra.h"
#include "renderer/color/rgb_primaries.h"
#include "renderer/color/rgb_table.h"
#include "renderer/color/srgb_table_data.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

// The colour of `spectrum` as light.
Rgb ColorOf(const ColorSpace& space, const Spectrum& spectrum) {
  DenseTable table;
  for (int i = 0; i < kLambdaCount; ++i) {
    table[static_cast<size_t>(i)] = spectrum.At(static_cast<float>(kLambdaMin + i));
  }
  const std::array<double, 3> xyz = XyzOf(table);
  return space.FromXyz({static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])});
}

// The colour of a reflectance under the white of the space.
Rgb ColorUnderWhite(const ColorSpace& space, const SigmoidPolynomial& albedo) {
  return ColorOf(space, Spectrum::SigmoidTimesTable(albedo, space.illuminant(), 1));
}

void ExpectNear(Rgb found, Rgb expected, float tolerance) {
  EXPECT_LE(MaxComponent(Abs(found - expected)), tolerance)
      << expected.x << ' ' << expected.y << ' ' << expected.z << " became " << found.x << ' ' << found.y
      << ' ' << found.z;
}

// Calls `visit` with the points of a grid over the cube of RGB, its faces and corners included.
template <typename Visit>
void ForColorGrid(int steps, const Visit& visit) {
  const auto level = [&](int i) { return static_cast<float>(i) / static_cast<float>(steps); };
  for (int r = 0; r <= steps; ++r) {
    for (int g = 0; g <= steps; ++g) {
      for (int b = 0; b <= steps; ++b) visit(Rgb{level(r), level(g), level(b)});
    }
  }
}

TEST(ColorSpace, NamesAreFoundInAnyCase) {
  EXPECT_EQ(ColorSpace::Named("sRGB"), &ColorSpace::Srgb());
  for (const char* name : {"DCI-P3", "Rec2020", "ACES2065-1"})
    ASSERT_NE(ColorSpace::Named(name), nullptr) << name;
  EXPECT_EQ(ColorSpace::Named("rec2020"), ColorSpace::Named("REC2020"));
  EXPECT_EQ(ColorSpace::Named("adobe"), nullptr);
  EXPECT_EQ(ColorSpace::Named(""), nullptr);
}

TEST(ColorSpace, MatricesAreThoseOfTheStandards) {
  const auto& srgb = ColorSpace::Srgb().rgb_from_xyz();  // IEC 61966-2-1
  EXPECT_NEAR(srgb[0][0], 3.2406f, 5e-4);
  EXPECT_NEAR(srgb[1][1], 1.8758f, 5e-4);
  EXPECT_NEAR(srgb[2][2], 1.0570f, 5e-4);
  const auto& rec2020 = ColorSpace::Named("rec2020")->rgb_from_xyz();  // ITU-R BT.2020
  EXPECT_NEAR(rec2020[0][0], 1.7167f, 5e-4);
  EXPECT_NEAR(rec2020[0][1], -0.3557f, 5e-4);
  const auto& aces = ColorSpace::Named("aces2065-1")->rgb_from_xyz();  // SMPTE ST 2065-1
  EXPECT_NEAR(aces[0][0], 1.0498f, 5e-4);
  EXPECT_NEAR(aces[1][0], -0.4959f, 5e-4);
}

TEST(ColorSpace, XyzThereAndBackIsTheSame) {
  for (const char* name : {"srgb", "dci-p3", "rec2020", "aces2065-1"}) {
    const ColorSpace& space = *ColorSpace::Named(name);
    const Rgb rgb{0.2f, 0.9f, 0.4f};
    ExpectNear(space.FromXyz(space.ToXyz(rgb)), rgb, 1e-6f);
    ExpectNear(ColorOf(space, Spectrum::Table(space.illuminant())), {1, 1, 1}, 1e-5f);
  }
}

TEST(AlbedoPolynomial, GivesBackEveryColorOfSrgb) {
  const ColorSpace& space = ColorSpace::Srgb();
  ForColorGrid(12,
               [&](Rgb rgb) { ExpectNear(ColorUnderWhite(space, space.AlbedoPolynomial(rgb)), rgb, 5e-4f); });
}

TEST(AlbedoPolynomial, FastOneGivesBackEveryColorOfSrgb) {
  const ColorSpace& space = ColorSpace::Srgb();
  ForColorGrid(
      23, [&](Rgb rgb) { ExpectNear(ColorUnderWhite(space, space.AlbedoPolynomialFast(rgb)), rgb, 2e-3f); });
  TestRandom random(3);
  for (int n = 0; n < 2000; ++n) {
    const float r = random.Next(), g = random.Next();
    const Rgb rgb{r * r, g * g * g, random.Next()};
    ExpectNear(ColorUnderWhite(space, space.AlbedoPolynomialFast(rgb)), rgb, 3e-3f);
  }
}

TEST(AlbedoPolynomial, WideSpacesGiveBackTheColorsThatReflectancesHave) {
  // Their most saturated bright colours are no reflectance's.
  for (const char* name : {"dci-p3", "rec2020", "aces2065-1"}) {
    const ColorSpace& space = *ColorSpace::Named(name);
    ForColorGrid(6, [&](Rgb rgb) {
      const Rgb pale = rgb * 0.3f + Rgb{0.3f, 0.3f, 0.3f};
      ExpectNear(ColorUnderWhite(space, space.AlbedoPolynomial(pale)), pale, 5e-4f);
    });
  }
}

TEST(AlbedoPolynomial, IsFiniteForEveryColorOfEverySpace) {
  for (const char* name : {"dci-p3", "rec2020", "aces2065-1", "srgb"}) {
    const ColorSpace& space = *ColorSpace::Named(name);
    ForColorGrid(7, [&](Rgb rgb) {
      const SigmoidPolynomial p = space.AlbedoPolynomial(rgb);
      EXPECT_TRUE(IsFinite({p.c0, p.c1, p.c2})) << name << rgb.x << ' ' << rgb.y << ' ' << rgb.z;
      const float largest = Spectrum::Sigmoid(p, 1).MaxValue();
      EXPECT_TRUE(largest >= 0 && largest <= 1);
    });
  }
}

TEST(AlbedoPolynomial, GreyIsConstantAndOutsideIsClamped) {
  const ColorSpace& space = ColorSpace::Srgb();
  for (const float v : {0.0f, 1e-5f, 0.18f, 0.5f, 0.999f, 1.0f}) {
    for (const SigmoidPolynomial& p :
         {space.AlbedoPolynomial({v, v, v}), space.AlbedoPolynomialFast({v, v, v})}) {
      EXPECT_EQ(p.c0, 0);
      EXPECT_EQ(p.c1, 0);
      EXPECT_NEAR(Spectrum::Sigmoid(p, 1).At(500), v, 1e-6);
    }
  }
  EXPECT_EQ(Spectrum::Sigmoid(space.AlbedoPolynomialFast({-1, -2, NAN}), 1).At(500), 0);
  EXPECT_EQ(Spectrum::Sigmoid(space.AlbedoPolynomialFast({7, 2, INFINITY}), 1).At(500), 1);
  for (const Rgb tiny : {Rgb{1e-40f, 0, 0}, Rgb{0, 1e-7f, 0}}) {
    EXPECT_LT(Spectrum::Sigmoid(space.AlbedoPolynomialFast(tiny), 1).MaxValue(), 1e-3f);
    EXPECT_LT(Spectrum::Sigmoid(space.AlbedoPolynomial(tiny), 1).MaxValue(), 1e-3f);
  }
}

TEST(SrgbTable, HoldsTheBitsThatEveryMachineComputes) {
  // FNV-1a over the bits. Changes if, and only if, the spectra of all coloured scenes change.
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = 0; i < kRgbTableFloats; ++i) {
    uint32_t bits;
    std::memcpy(&bits, SrgbTable() + i, sizeof bits);
    hash = (hash ^ bits) * 0x100000001b3u;
  }
  EXPECT_EQ(hash, 3428372219259514594u);
}

TEST(ToSpectrum, UnboundedColorsKeepTheirColorUnderWhite) {
  const ColorSpace& space = ColorSpace::Srgb();
  for (const Rgb rgb :
       {Rgb{12, 3, 0.5f}, Rgb{0.001f, 0.02f, 0.3f}, Rgb{0, 0, 100}, Rgb{2, 2, 2}, Rgb{0, 0, 0}}) {
    const Spectrum spectrum = space.ToSpectrum(rgb, SpectrumUse::kUnbounded);
    DenseTable lit;
    for (int i = 0; i < kLambdaCount; ++i) {
      const size_t place = static_cast<size_t>(i);
      lit[place] = spectrum.At(static_cast<float>(kLambdaMin + i)) * (*space.illuminant())[place];
    }
    const Rgb found = ColorOf(space, Spectrum::Table(std::make_shared<const DenseTable>(lit)));
    ExpectNear(found, rgb, 2e-3f * MaxComponent(rgb) + 1e-6f);
  }
}

TEST(ToSpectrum, LightsNormalisedByTheirWhiteHaveTheirRgb) {
  for (const char* name : {"srgb", "rec2020", "aces2065-1"}) {
    const ColorSpace& space = *ColorSpace::Named(name);
    for (const Rgb rgb : {Rgb{1, 1, 1}, Rgb{17, 12, 4}, Rgb{0.3f, 0.3f, 0.5f}, Rgb{0, 0, 0}}) {
      const Spectrum light = space.ToSpectrum(rgb, SpectrumUse::kIlluminant);
      const Spectrum normalised = light.Scaled(1 / SpectrumToPhotometric(light.WithoutColor()));
      // Without the division by the integral of y-bar, which the normalisation has replaced.
      const Rgb found = ColorOf(space, normalised.Scaled(kCieYIntegral));
      ExpectNear(found, rgb, 2e-3f * MaxComponent(rgb) + 1e-6f);
    }
  }
}

TEST(ToSpectrum, WhiteLightIsTheIlluminant) {
  const ColorSpace& space = ColorSpace::Srgb();
  const Spectrum light = space.ToSpectrum({3, 3, 3}, SpectrumUse::kIlluminant);
  for (const float lambda : {400.0f, 550.0f, 700.0f}) {
    EXPECT_FLOAT_EQ(light.At(lambda), 3 * Spectrum::Table(space.illuminant()).At(lambda));
    EXPECT_FLOAT_EQ(light.WithoutColor().At(lambda), Spectrum::Table(space.illuminant()).At(lambda));
  }
}

TEST(SampleFast, IsTheSpectrumAtTheWavelengths) {
  const ColorSpace& space = ColorSpace::Srgb();
  TestRandom random(11);
  for (int n = 0; n < 300; ++n) {
    const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(random.Next());
    const float r = random.Next(), g = random.Next();
    const Rgb rgb = n % 10 == 0 ? Rgb{r, r, r} : Rgb{r, g, random.Next()};
    for (const SpectrumUse use : {SpectrumUse::kAlbedo, SpectrumUse::kUnbounded, SpectrumUse::kIlluminant}) {
      const SampledSpectrum fast = space.SampleFast(rgb, use, wavelengths);
      const SampledSpectrum slow = space.ToSpectrum(rgb, use).Sample(wavelengths);
      for (int i = 0; i < 4; ++i) ASSERT_NEAR(fast[i], slow[i], 2e-6f * (1 + slow[i]));
    }
  }
}

TEST(Spectrum, SampleAgreesWithAtOnWholeNanometres) {
  const ColorSpace& space = ColorSpace::Srgb();
  const Spectrum spectrum = space.ToSpectrum({0.2f, 0.5f, 0.9f}, SpectrumUse::kIlluminant);
  SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(0);
  wavelengths.lambda = Float4(360, 480, 601, 830);
  wavelengths.index = _mm_setr_epi32(0, 120, 241, 470);
  const SampledSpectrum sampled = spectrum.Sample(wavelengths);
  for (int i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(sampled[i], spectrum.At(wavelengths.lambda[i]));
}

TEST(Spectrum, KnowsItsMaximumAndItsKind) {
  const Spectrum ramp =
      Spectrum::Table(TableFromSamples(std::array{400.0f, 600.0f}, std::array{0.0f, 4.0f}), 2);
  EXPECT_FLOAT_EQ(ramp.MaxValue(), 8);
  EXPECT_FLOAT_EQ(ramp.Scaled(0.5f).At(500), 2);
  EXPECT_EQ(ramp.At(359), 0);
  EXPECT_EQ(ramp.At(831), 0);
  EXPECT_FALSE(ramp.IsConstant());
  EXPECT_TRUE(Spectrum::Constant(3).IsConstant());
  EXPECT_FLOAT_EQ(Spectrum::Constant(3).MaxValue(), 3);
  EXPECT_FLOAT_EQ(ramp.WithoutColor().At(500), ramp.At(500));
  EXPECT_NEAR(SpectrumToPhotometric(Spectrum::Constant(1)), kCieYIntegral, 1e-3);
}

}  // namespace
}  // namespace tessera
