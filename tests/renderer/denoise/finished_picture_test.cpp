#include "renderer/denoise/finished_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/denoise/denoise.h"
#include "renderer/film/picture_file.h"
#include "tests/renderer/denoise/noisy_picture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// The frame of a picture that Rendered makes.
FrameSpec SpecOf(const LoadedPicture& picture, ExrType type) {
  FrameSpec spec;
  spec.width = picture.width;
  spec.height = picture.height;
  spec.crop = picture.bounds;
  spec.samples_per_pixel = 16;
  spec.exr_type = type;
  spec.attributes = {{kSamplesAttribute, "16"}};
  spec.channels.clear();
  for (const std::string& name : picture.channels)
    spec.channels.push_back({name, name.size() == 1 ? ChannelType::kColor : ChannelType::kFloat});
  spec.channels.push_back({"W", ChannelType::kWeight, MergeRule::kSum, false});
  spec.denoiser = Denoiser::kRegression;
  return spec;
}

FramePicture FrameOf(const LoadedPicture& picture) {
  return {picture.bounds, picture.channels, picture.values, 16};
}

LoadedPicture Noisy() {
  return Rendered(40, 30, 0.5f, [](int x, int) { return Point{1, x < 20 ? 0.3f : 0.7f}; });
}

TEST(EncodeFinished, WritesAPlainFrameAsItIs) {
  const LoadedPicture noisy = Noisy();
  FrameSpec spec = SpecOf(noisy, ExrType::kHalf);
  spec.denoiser = Denoiser::kNone;
  const auto encoded = EncodeFinished(spec, FrameOf(noisy), 1, {});
  ASSERT_TRUE(encoded);
  EXPECT_TRUE(encoded->exr == *EncodeExr(spec, FrameOf(noisy)));
  EXPECT_EQ(encoded->denoise_failed, "");
}

TEST(EncodeFinished, DenoisesTheColoursBeforeTheyAreRounded) {
  const LoadedPicture noisy = Noisy();
  for (const ExrType type : {ExrType::kHalf, ExrType::kFloat}) {
    const FrameSpec spec = SpecOf(noisy, type);
    const auto one = EncodeFinished(spec, FrameOf(noisy), 1, {});
    const auto four = EncodeFinished(spec, FrameOf(noisy), 4, {});
    ASSERT_TRUE(one && four);
    EXPECT_EQ(one->denoise_failed, "");
    EXPECT_TRUE(one->exr == four->exr);
    LoadedPicture file = *DecodeExr(one->exr, "p.exr"), denoised = *Denoise(noisy, "p.exr", 2, {});
    EXPECT_EQ(file.attributes.at(kDenoiserAttribute), "regression");
    for (const char* channel : {"R", "noisy.G", "halves.B", "albedo.R"}) {
      const float value = Value(denoised, channel, 13, 7);
      EXPECT_NEAR(Value(file, channel, 13, 7), value, type == ExrType::kHalf ? 1e-3f * std::abs(value) : 0)
          << channel;
    }
  }
}

TEST(EncodeFinished, WritesANoisyPictureThatSaysSoIfItCannotBeDenoised) {
  LoadedPicture noisy = Noisy();
  // A frame like this is not accepted; it stands for one that there is not enough memory for.
  std::ranges::replace(noisy.channels, "albedo.G", "other.G");
  const FrameSpec spec = SpecOf(noisy, ExrType::kFloat);
  const auto encoded = EncodeFinished(spec, FrameOf(noisy), 2, {});
  ASSERT_TRUE(encoded);
  EXPECT_THAT(encoded->denoise_failed, HasSubstr("without the layer albedo"));
  LoadedPicture file = *DecodeExr(encoded->exr, "p.exr");
  EXPECT_EQ(file.attributes.at(kDenoiseFailedAttribute), encoded->denoise_failed);
  EXPECT_FALSE(file.attributes.contains(kDenoiserAttribute));
  EXPECT_EQ(Value(file, "R", 3, 4), Value(noisy, "R", 3, 4));
}

TEST(EncodeFinished, EndsWithoutAPictureWhenAskedToStop) {
  const LoadedPicture noisy = Noisy();
  std::stop_source stop;
  stop.request_stop();
  const auto encoded = EncodeFinished(SpecOf(noisy, ExrType::kHalf), FrameOf(noisy), 2, stop.get_token());
  ASSERT_FALSE(encoded);
  EXPECT_EQ(encoded.error().kind, ErrorKind::kInterrupted);
}

TEST(CheckDenoiser, NamesWhatAFrameLacks) {
  LoadedPicture noisy = Noisy();
  FrameSpec spec = SpecOf(noisy, ExrType::kHalf);
  EXPECT_TRUE(CheckDenoiser(spec, "s.pbrt"));
  spec.attributes[kSamplesAttribute] = "4";
  EXPECT_THAT(CheckDenoiser(spec, "s.pbrt").error().message, HasSubstr("s.pbrt: is rendered with 4 samples"));
  spec.denoiser = Denoiser::kNone;
  EXPECT_TRUE(CheckDenoiser(spec, "s.pbrt"));
  spec = SpecOf(noisy, ExrType::kHalf);
  for (Channel& channel : spec.channels) {
    if (channel.name == "halves.B") channel.is_written = false;
  }
  EXPECT_THAT(CheckDenoiser(spec, "s.pbrt").error().message, HasSubstr("without the layer halves"));
  spec = SpecOf(noisy, ExrType::kHalf);
  while (spec.channels.size() < static_cast<size_t>(kChannelsMax))
    AddChannel(spec.channels, {"c" + std::to_string(spec.channels.size()), ChannelType::kFloat});
  ASSERT_TRUE(spec.Check());
  EXPECT_THAT(CheckDenoiser(spec, "s.pbrt").error().message,
              HasSubstr("would have 258 channels, more than the limit of 256"));
}

}  // namespace
}  // namespace tessera
