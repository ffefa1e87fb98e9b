#include "renderer/denoise/denoise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/renderer/denoise/noisy_picture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

LoadedPicture Denoised(const LoadedPicture& picture, int threads = 2) {
  auto denoised = Denoise(picture, "p.exr", threads, {});
  EXPECT_TRUE(denoised) << denoised.error().message;
  return std::move(denoised).value();
}

bool IsFinite(LoadedPicture picture) {
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      for (const char* name : {"R", "G", "B"}) {
        if (!std::isfinite(Value(picture, name, x, y))) return false;
      }
    }
  }
  return true;
}

TEST(Denoise, RemovesTheNoiseOfSmoothLightAndKeepsTextures) {
  const PaintPoint textured = [](int x, int y) {
    const float light = 2 + static_cast<float>(x) / 40 + std::sin(static_cast<float>(y) / 15);
    return Point{light, (x / 2 + y / 3) % 2 == 0 ? 0.8f : 0.1f, 0, 1};
  };
  const LoadedPicture noisy = Rendered(80, 70, 0.5f, textured);
  const double before = ErrorOf(noisy, textured), after = ErrorOf(Denoised(noisy), textured);
  EXPECT_GT(before, 0.03);
  EXPECT_LT(after, before / 10);
}

TEST(Denoise, KeepsEdgesOfFeaturesAndOfLight) {
  // Light changes at x = 20 with the normal, at x = 40 with the depth and at x = 60 with nothing.
  const PaintPoint edges = [](int x, int) {
    return Point{x < 20   ? 1.0f
                 : x < 40 ? 3.0f
                 : x < 60 ? 1.0f
                          : 5.0f,
                 0.5f, x < 20 ? 0.0f : 0.8f, x < 40 ? 1.0f : 2.0f};
  };
  const LoadedPicture noisy = Rendered(80, 60, 0.3f, edges);
  const double before = ErrorOf(noisy, edges);
  EXPECT_LT(ErrorOf(Denoised(noisy), edges), before / 10);
}

// A pane of glass, whose own albedo and normal are the same everywhere, before a pattern.
TEST(Denoise, IsGuidedByWhatIsSeenThroughGlass) {
  const auto is_dark = [](int x, int y) { return (x / 2 + y / 3) % 2 == 0; };
  const PaintPoint seen = [&](int x, int y) { return Point{is_dark(x, y) ? 0.8f : 1.2f, 1, 0, 1}; };
  const LoadedPicture noisy = Rendered(80, 70, 0.8f, seen);
  LoadedPicture guided = noisy;
  const std::vector<std::string> guides{"denoising_albedo.B", "denoising_albedo.G", "denoising_albedo.R",
                                        "denoising_normal.X", "denoising_normal.Y", "denoising_normal.Z"};
  guided.channels.insert(guided.channels.end(), guides.begin(), guides.end());
  guided.types.clear();
  guided.values.clear();
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 80; ++x) {
      const auto pixel = noisy.values.begin() + (y * 80 + x) * static_cast<int>(kNoisyChannels.size());
      guided.values.insert(guided.values.end(), pixel, pixel + static_cast<int>(kNoisyChannels.size()));
      const float albedo = is_dark(x, y) ? 0.2f : 0.8f;
      for (const float value : {albedo, albedo, albedo, 0.0f, 0.0f, 1.0f}) guided.values.push_back(value);
    }
  }
  const double without = ErrorOf(Denoised(noisy), seen), with = ErrorOf(Denoised(guided), seen);
  EXPECT_LT(with, without / 2);
}

// Glass that reflects or shows what is beyond it at random: colours and guides have the same noise.
TEST(Denoise, DoesNotTakeTheNoiseOfGuidesForDetail) {
  const PaintPoint glass = [](int, int) { return Point{1, 1, 0, 1}; };
  LoadedPicture noisy = Rendered(80, 60, 0.2f, glass);
  noisy.channels.insert(noisy.channels.end(),
                        {"denoising_albedo.B", "denoising_albedo.G", "denoising_albedo.R"});
  std::vector<float> values;
  for (size_t pixel = 0; pixel < 80 * 60; ++pixel) {
    const float* const from = &noisy.values[pixel * kNoisyChannels.size()];
    values.insert(values.end(), from, from + kNoisyChannels.size());
    const float red = from[2];
    values.insert(values.end(), {0.3f * red, 0.3f * red, 0.3f * red});
  }
  noisy.values = std::move(values);
  EXPECT_LT(ErrorOf(Denoised(noisy), glass), ErrorOf(noisy, glass) / 12);
}

// As those of well distributed samples: each half is noisy, but their mean is not.
TEST(Denoise, KeepsEdgesOfLightThatTheNoiseOfTheHalvesHides) {
  const PaintPoint edges = [](int x, int) { return Point{x % 20 < 10 ? 1.0f : 1.4f, 0.5f, 0, 1}; };
  LoadedPicture noisy = Rendered(80, 60, 0, edges);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      for (const char* name : {"R", "G", "B"})
        Value(noisy, std::string("halves.") + name, x, y) =
            0.2f * Noise(x, y, *name) * Value(noisy, name, x, y);
    }
  }
  EXPECT_LT(ErrorOf(Denoised(noisy), edges), 1e-4);
}

TEST(Denoise, LeavesAPictureWithoutNoiseAsItIs) {
  const PaintPoint shapes = [](int x, int y) {
    return Point{1 + static_cast<float>((x / 9 + y / 7) % 3), 0.3f + 0.1f * static_cast<float>(x % 5), 0, 1};
  };
  LoadedPicture denoised = Denoised(Rendered(50, 40, 0, shapes));
  EXPECT_LT(ErrorOf(denoised, shapes), 2e-4);
}

TEST(Denoise, ShowsNoSeamsBetweenItsTilesAndStrips) {
  // The same pixels at a place where a strip ends and at one in the middle of a strip.
  const auto shifted = [](int shift) {
    return Rendered(70, 330, 0.4f, [shift](int x, int y) {
      return Point{
          2 + std::sin(static_cast<float>((y + shift) * 13 + x) / 29) + 0.2f * Noise(x, y + shift, 7), 0.5f,
          0, 1};
    });
  };
  // The noise has to be shifted as well. Only rows far from the borders of the picture are the same.
  LoadedPicture still = shifted(0), moved = still;
  const size_t row = 70 * kNoisyChannels.size();
  std::rotate(moved.values.begin(), moved.values.begin() + static_cast<ptrdiff_t>(32 * row),
              moved.values.end());
  LoadedPicture a = Denoised(still), b = Denoised(moved);
  for (int y = 110; y < 240; ++y) {
    for (int x = 0; x < 70; ++x)
      EXPECT_NEAR(Value(a, "R", x, y), Value(b, "R", x, y - 32), 2e-4f) << x << " " << y;
  }
}

TEST(Denoise, TakesPicturesOfAnySize) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {33, 31}, {32, 32}, {5, 200}}) {
    const PaintPoint plain = [](int, int) { return Point{2, 0.5f, 0, 1}; };
    const LoadedPicture denoised = Denoised(Rendered(width, height, 0.2f, plain));
    EXPECT_EQ(denoised.bounds.area(), width * height);
    EXPECT_LT(ErrorOf(denoised, plain), 0.02) << width << "x" << height;
  }
}

TEST(Denoise, DarkensFirefliesAndGivesFiniteColorsForAnyInput) {
  const PaintPoint plain = [](int, int) { return Point{1, 0.5f, 0, 1}; };
  LoadedPicture picture = Rendered(64, 64, 0.2f, plain);
  // One bright sample in one half.
  Value(picture, "R", 20, 20) = 500;
  Value(picture, "halves.R", 20, 20) = 499;
  LoadedPicture firefly = Denoised(picture);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) EXPECT_LT(Value(firefly, "R", x, y), 1) << x << " " << y;
  }
  int k = 0;
  for (const std::string& channel : kNoisyChannels) {
    for (const float bad : {kNan, kInfinity, -kInfinity, 3e38f, -3e38f})
      Value(picture, channel, 5 + 3 * (k % 19), 3 * (k / 19) + 2) = bad, ++k;
  }
  EXPECT_TRUE(IsFinite(Denoised(picture)));
  for (float& value : picture.values) value = kNan;
  EXPECT_TRUE(IsFinite(Denoised(picture)));
  for (float& value : picture.values) value = kInfinity;
  EXPECT_TRUE(IsFinite(Denoised(picture)));
}

// Adds a bright sample to one half of a pixel of each square of 7 x 7 pixels.
void AddFireflies(LoadedPicture& picture) {
  constexpr int kSquare = 7;
  const auto offset = [](int x, int y, int k) {
    return std::min(static_cast<int>((Noise(x, y, k) + 1) * 0.5f * kSquare), kSquare - 1);
  };
  for (int y0 = 0; y0 + kSquare <= picture.height; y0 += kSquare) {
    for (int x0 = 0; x0 + kSquare <= picture.width; x0 += kSquare) {
      const int x = x0 + offset(x0, y0, 97), y = y0 + offset(x0, y0, 98);
      const float sign = Noise(x0, y0, 99) < 0 ? -1.0f : 1.0f;
      for (const char* name : {"R", "G", "B"}) {
        const float bright = 6 * Value(picture, std::string("albedo.") + name, x, y);
        Value(picture, name, x, y) += bright;
        Value(picture, std::string("halves.") + name, x, y) += bright * sign;
      }
    }
  }
}

double MeanOf(LoadedPicture picture) {
  double sum = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) sum += double{Value(picture, "R", x, y)};
  }
  return sum / (picture.width * picture.height);
}

TEST(Denoise, SpreadsTheLightOfFirefliesSoThatThePictureKeepsItsMean) {
  LoadedPicture noisy = Rendered(192, 160, 0.3f, [](int, int) { return Point{1, 1, 0, 1}; });
  AddFireflies(noisy);
  LoadedPicture denoised = Denoised(noisy);
  EXPECT_GT(MeanOf(noisy), 1.1);
  EXPECT_NEAR(MeanOf(denoised), MeanOf(noisy), 0.01);
  float darkest = 1, brightest = 1;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 192; ++x) {
      darkest = std::min(darkest, Value(denoised, "R", x, y));
      brightest = std::max(brightest, Value(denoised, "R", x, y));
    }
  }
  EXPECT_GT(darkest, 0.85f);
  EXPECT_LT(brightest, 1.5f);
}

TEST(Denoise, BrightensNothingForTheLightOfOneFireflyOrForValuesThatAreNoNumbers) {
  LoadedPicture noisy = Rendered(96, 96, 0.2f, [](int, int) { return Point{1, 1, 0, 1}; });
  LoadedPicture plain = Denoised(noisy);
  for (const float bad : {1e4f, 1e30f, kInfinity, -kInfinity, kNan}) {
    LoadedPicture picture = noisy;
    for (const char* name : {"R", "G", "B"}) {
      Value(picture, name, 48, 48) = bad;
      Value(picture, std::string("halves.") + name, 48, 48) = bad;
    }
    LoadedPicture denoised = Denoised(picture);
    for (const int x : {20, 36, 60, 76})
      EXPECT_NEAR(Value(denoised, "R", x, 48), Value(plain, "R", x, 48), 0.02f) << bad << " " << x;
  }
}

TEST(Denoise, GivesTheSameBitsForAnyNumberOfThreads) {
  LoadedPicture noisy = Rendered(150, 230, 0.5f, [](int x, int y) {
    return Point{1 + static_cast<float>(x * y) / 5000, 0.5f, static_cast<float>(x % 7) / 10, 1};
  });
  AddFireflies(noisy);
  const LoadedPicture one = Denoised(noisy, 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(Denoised(noisy, threads).values, one.values) << threads;
}

TEST(Denoise, KeepsWhatIsBrightInBothHalves) {
  const LoadedPicture noisy = Rendered(40, 40, 0.1f, [](int x, int y) {
    return Point{x == 20 && y == 20 ? 100.0f : 1.0f, 0.5f, x == 20 && y == 20 ? 0.9f : 0.0f, 1};
  });
  LoadedPicture denoised = Denoised(noisy);
  EXPECT_GT(Value(denoised, "R", 20, 20), 30);
  EXPECT_LT(Value(denoised, "R", 24, 20), 0.8f);
}

TEST(Denoise, KeepsTheNoisyColorsAndAllOtherLayers) {
  LoadedPicture noisy = Rendered(20, 20, 0.5f, [](int, int) { return Point{}; });
  noisy.attributes["tessera:seed"] = "7";
  noisy.attributes[kDenoiseFailedAttribute] = "for want of memory";
  LoadedPicture once = Denoised(noisy);
  for (const std::string& channel : kNoisyChannels) {
    const std::string kept = channel.size() == 1 ? "noisy." + channel : channel;
    for (int i = 0; i < 20; ++i) EXPECT_EQ(Value(once, kept, i, 7), Value(noisy, channel, i, 7)) << kept;
  }
  EXPECT_NE(Value(once, "R", 3, 3), Value(noisy, "R", 3, 3));
  EXPECT_EQ(once.attributes.at("tessera:seed"), "7");
  EXPECT_EQ(once.attributes.at(kDenoiserAttribute), "regression");
  EXPECT_FALSE(once.attributes.contains(kDenoiseFailedAttribute));
  EXPECT_EQ(once.channels.size(), noisy.channels.size() + 3 * AddedLayers(noisy).size());
  EXPECT_TRUE(AddedLayers(once).empty());
  LoadedPicture twice = Denoised(once);
  EXPECT_EQ(twice.channels.size(), once.channels.size());
  for (const std::string& channel : once.channels)
    EXPECT_EQ(Value(twice, channel, 5, 5), Value(once, channel, 5, 5));
}

TEST(Denoise, KeepsTheTypesOfChannelsAndTheFormatOfTheFile) {
  LoadedPicture noisy = Rendered(20, 20, 0.5f, [](int, int) { return Point{}; });
  for (const std::string& channel : noisy.channels)
    noisy.types.push_back(channel.size() == 1 ? ExrType::kHalf : ExrType::kFloat);
  noisy.format = {ExrCompression::kPiz, true, true};
  const LoadedPicture denoised = Denoised(noisy);
  EXPECT_EQ(denoised.format, noisy.format);
  ASSERT_EQ(denoised.types.size(), denoised.channels.size());
  for (size_t c = 0; c < denoised.channels.size(); ++c) {
    const std::string& name = denoised.channels[c];
    const bool is_color = name.size() == 1 || name.starts_with("noisy.");
    EXPECT_EQ(denoised.types[c], is_color ? ExrType::kHalf : ExrType::kFloat) << name;
  }
}

TEST(Denoise, NamesTheLayersThatAreMissing) {
  LoadedPicture picture = Rendered(4, 4, 0, [](int, int) { return Point{}; });
  for (std::string& channel : picture.channels) {
    if (channel == "albedo.G" || channel == "halves.R") channel = "x." + channel;
  }
  const auto denoised = Denoise(picture, "p.exr", 1, {});
  ASSERT_FALSE(denoised);
  EXPECT_EQ(denoised.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(denoised.error().message,
            "p.exr: cannot be denoised without the layers albedo, halves; render it with --aov denoise");
  EXPECT_FALSE(CheckDenoisable(picture, "p.exr"));
}

TEST(Denoise, KnowsHowManySamplesEachHalfHas) {
  const PaintPoint plain = [](int, int) { return Point{2, 0.5f, 0, 1}; };
  LoadedPicture picture = Rendered(30, 30, 0, plain);
  // Of 12 samples, 8 are in the first half, so the difference of the sums is a third of all.
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 30; ++x) {
      for (const char* name : {"R", "G", "B"})
        Value(picture, std::string("halves.") + name, x, y) = Value(picture, name, x, y) / 3;
    }
  }
  picture.attributes["tessera:samplesPerPixel"] = "12";
  EXPECT_LT(ErrorOf(Denoised(picture), plain), 1e-6);
  for (const char* few : {"1", "4"}) {
    picture.attributes["tessera:samplesPerPixel"] = few;
    const auto refused = Denoise(picture, "p.exr", 1, {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("denoising needs at least 8"));
  }
  for (const char* bad : {"", "-3", "x", "0", "99999999999999999999", "12 "}) {
    picture.attributes["tessera:samplesPerPixel"] = bad;
    EXPECT_FALSE(Denoise(picture, "p.exr", 1, {})) << bad;
  }
}

TEST(Denoise, StopsWhenAskedTo) {
  std::stop_source stop;
  stop.request_stop();
  const auto denoised =
      Denoise(Rendered(40, 40, 0, [](int, int) { return Point{}; }), "p.exr", 2, stop.get_token());
  ASSERT_FALSE(denoised);
  EXPECT_EQ(denoised.error().kind, ErrorKind::kInterrupted);
}

}  // namespace
}  // namespace tessera
