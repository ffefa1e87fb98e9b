#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/denoise/denoise.h"
#include "renderer/film/relight.h"
#include "tests/renderer/denoise/noisy_picture.h"

namespace tessera {
namespace {

constexpr int kWidth = 70, kHeight = 50;

// What the lamp and the sky give a pixel.
float Lamp(int x, int) {
  return x < 35 ? 2.0f : 0.5f;
}
float Sky(int, int y) {
  return 1 + 0.5f * std::sin(static_cast<float>(y) / 9);
}

// Lit by a lamp, by the sky, and by others, which are off.
LoadedPicture LitByGroups(float noise) {
  const auto paint = [](float (*light)(int, int)) {
    return [light](int x, int y) {
      return Point{light(x, y), (x / 3) % 2 == 0 ? 0.8f : 0.2f, x < 35 ? 0.0f : 0.5f};
    };
  };
  LoadedPicture lamp = Rendered(kWidth, kHeight, noise, paint(Lamp), 1);
  LoadedPicture sky = Rendered(kWidth, kHeight, noise, paint(Sky), 2);
  LoadedPicture all = lamp;
  for (const char* name : {"light_lamp", "light_others", "light_sky"}) {
    for (const char* color : {".R", ".G", ".B"}) all.channels.push_back(std::string(name) + color);
  }
  all.values.assign(static_cast<size_t>(kWidth * kHeight) * all.channels.size(), 0.0f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (const std::string& channel : lamp.channels) Value(all, channel, x, y) = Value(lamp, channel, x, y);
      for (const std::string color : {"R", "G", "B"}) {
        for (const std::string& channel : {color, "halves." + color})
          Value(all, channel, x, y) += Value(sky, channel, x, y);
        Value(all, "light_lamp." + color, x, y) = Value(lamp, color, x, y);
        Value(all, "light_sky." + color, x, y) = Value(sky, color, x, y);
      }
    }
  }
  return all;
}

double GroupError(LoadedPicture& picture, const std::string& channel, float (*light)(int, int)) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double truth = static_cast<double>(light(x, y)) * ((x / 3) % 2 == 0 ? 0.8 : 0.2);
      sum += std::pow((Value(picture, channel, x, y) - truth) / truth, 2);
    }
  }
  return sum / (kWidth * kHeight);
}

LoadedPicture DenoisedGroups(const LoadedPicture& picture, int threads = 2) {
  auto denoised = Denoise(picture, "p.exr", threads, {});
  EXPECT_TRUE(denoised) << denoised.error().message;
  return std::move(denoised).value();
}

TEST(DenoisedGroups, LoseTheirNoiseAndSumToTheDenoisedPicture) {
  LoadedPicture noisy = LitByGroups(0.5f), denoised = DenoisedGroups(noisy);
  EXPECT_LT(GroupError(denoised, "light_lamp.R", Lamp), GroupError(noisy, "light_lamp.R", Lamp) / 8);
  EXPECT_LT(GroupError(denoised, "light_sky.R", Sky), GroupError(noisy, "light_sky.R", Sky) / 6);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (const std::string color : {"R", "G", "B"}) {
        const float lamp = Value(denoised, "light_lamp." + color, x, y);
        const float sky = Value(denoised, "light_sky." + color, x, y);
        const float others = Value(denoised, "light_others." + color, x, y);
        const float all = Value(denoised, color, x, y);
        ASSERT_NEAR(lamp + sky + others, all, 1e-6f * all) << x << " " << y;
        ASSERT_GE(std::min({lamp, sky, others}), 0);
      }
    }
  }
}

TEST(DenoisedGroups, LeaveTheColoursAsTheyAreWithoutThem) {
  const LoadedPicture with_groups = LitByGroups(0.5f);
  LoadedPicture without = with_groups;
  for (std::string& channel : without.channels) {
    if (channel.starts_with("light_")) channel = "other_" + channel;
  }
  LoadedPicture a = DenoisedGroups(with_groups), b = DenoisedGroups(without);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) EXPECT_EQ(Value(a, "G", x, y), Value(b, "G", x, y));
  }
}

TEST(DenoisedGroups, AreMixedByRelight) {
  LoadedPicture denoised = DenoisedGroups(LitByGroups(0.5f));
  const LightGain gains[] = {{"lamp", {2, 2, 2}}, {"sky", {0, 0, 0}}};
  auto mixed = Relight(denoised, gains);
  ASSERT_TRUE(mixed) << mixed.error().message;
  EXPECT_FLOAT_EQ(Value(*mixed, "R", 20, 20),
                  2 * Value(denoised, "light_lamp.R", 20, 20) + Value(denoised, "light_others.R", 20, 20));
  for (const std::string& channel : mixed->channels)
    EXPECT_FALSE(channel.starts_with("noisy")) << "no longer fits";
}

TEST(DenoisedGroups, KeepTheirNoisyLightAndAreDenoisedOnce) {
  LoadedPicture noisy = LitByGroups(0.5f);
  LoadedPicture once = DenoisedGroups(noisy, 1), twice = DenoisedGroups(once, 3);
  EXPECT_EQ(once.channels.size(), noisy.channels.size() + 3 * 4)
      << "noisy colours, and those of three groups";
  ASSERT_EQ(twice.channels.size(), once.channels.size());
  for (const std::string& channel : once.channels) {
    EXPECT_EQ(Value(twice, channel, 9, 31), Value(once, channel, 9, 31)) << channel;
    if (!channel.starts_with("noisy_")) continue;
    EXPECT_EQ(Value(once, channel, 9, 31), Value(noisy, channel.substr(6), 9, 31)) << channel;
  }
}

}  // namespace
}  // namespace tessera
