// Everything that comes in through messages: good values survive the way there and back, bad ones are
// refused.
#include "proto/wire/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "proto/jobs.pb.h"
#include "proto/work.pb.h"
#include "tests/proto/wire/frame_examples.h"

namespace tessera {
namespace {

TEST(Convert, RefusesHostileFrames) {
  const std::pair<const char*, std::function<void(proto::FrameSpec&)>> table[] = {
      {"negative width", [](auto& m) { m.set_width(-1); }},
      {"zero height", [](auto& m) { m.set_height(0); }},
      {"huge width", [](auto& m) { m.set_width(1 << 30); }},
      {"no crop", [](auto& m) { m.clear_crop(); }},
      {"crop outside", [](auto& m) { m.mutable_crop()->set_x1(101); }},
      {"crop turned round", [](auto& m) { m.mutable_crop()->set_x1(5); }},
      {"crop negative", [](auto& m) { m.mutable_crop()->set_x0(-5); }},
      {"no samples", [](auto& m) { m.set_samples_per_pixel(0); }},
      {"too many samples", [](auto& m) { m.set_samples_per_pixel(kSamplesPerPixelMax + 1); }},
      {"no tiles", [](auto& m) { m.set_tile_size(0); }},
      {"huge tiles", [](auto& m) { m.set_tile_size(1 << 20); }},
      {"no channels", [](auto& m) { m.clear_channels(); }},
      {"nameless channel", [](auto& m) { m.mutable_channels(0)->clear_name(); }},
      {"channel of two lines", [](auto& m) { m.mutable_channels(0)->set_name("a\nb"); }},
      {"unknown type", [](auto& m) { m.set_exr_type(static_cast<proto::ExrType>(9)); }},
      {"unknown denoiser", [](auto& m) { m.set_denoiser(static_cast<uint32_t>(kDenoiserLast) + 1); }},
      {"no levels of Cryptomatte", [](auto& m) { m.set_cryptomatte_levels(0); }},
      {"more levels of Cryptomatte than there may be",
       [](auto& m) { m.set_cryptomatte_levels(kCryptomatteLevelsMax + 1); }},
      {"huge number of levels of Cryptomatte", [](auto& m) { m.set_cryptomatte_levels(0xffffffffu); }},
      {"negative threshold", [](auto& m) { m.set_noise_threshold(-0.1); }},
      {"large threshold", [](auto& m) { m.set_noise_threshold(1.5); }},
      {"no threshold at all",
       [](auto& m) { m.set_noise_threshold(std::numeric_limits<double>::quiet_NaN()); }},
      {"threshold without colour",
       [](auto& m) {
         for (int c = 0; c < 3; ++c) m.mutable_channels(c)->set_name("c" + std::to_string(c));
       }},
      {"samples twice", [](auto& m) { m.mutable_channels(0)->set_name(kSamplesChannel); }},
      {"channel of an unknown type", [](auto& m) { m.mutable_channels(0)->set_type(6); }},
      {"channel of an unknown rule", [](auto& m) { m.mutable_channels(0)->set_merge_rule(3); }},
      {"names of channels without a weight",
       [](auto& m) {
         m.clear_channels();
         m.add_channel_names("R");
         m.add_channel_names(kSamplesChannel);
       }},
      {"attribute without name", [](auto& m) { (*m.mutable_attributes())[""] = "x"; }},
      {"long attribute",
       [](auto& m) { (*m.mutable_attributes())["x"] = std::string(kAttributesBytesMax, 'x'); }},
      {"too many channels",
       [](auto& m) {
         for (int i = 0; i < kChannelsMax; ++i) m.add_channels()->set_name("c" + std::to_string(i));
       }},
      {"results beyond a message",
       [](auto& m) {
         m.set_tile_size(kTileSizeMax);
         for (int i = 0; i < 99; ++i) m.add_channels()->set_name("c" + std::to_string(i));
       }},
      {"ids beyond a message",
       [](auto& m) {
         m.set_tile_size(kTileSizeMax);
         proto::Channel& ids = *m.add_channels();
         ids.set_name("crypto");
         ids.set_type(static_cast<uint32_t>(ChannelType::kIds));
         ids.set_merge_rule(static_cast<uint32_t>(MergeRule::kIdWeights));
       }},
  };
  for (const auto& [what, spoil] : table) {
    proto::FrameSpec message;
    Write(GoodFrame(), message);
    spoil(message);
    const auto read = ReadFrameSpec(message);
    ASSERT_FALSE(read) << what;
    EXPECT_EQ(read.error().kind, ErrorKind::kBadInput) << what;
  }
}

TEST(Convert, ChannelsOfNamesAloneAreRead) {
  const FrameSpec frame = GoodFrame();
  proto::FrameSpec message;
  Write(frame, message);
  message.clear_channels();
  for (const Channel& channel : frame.channels) message.add_channel_names(channel.name);
  message.set_writes_samples(true);
  EXPECT_EQ(ReadFrameSpec(message).value(), frame);
}

TEST(Convert, AFrameWithoutANumberOfCryptomatteLevelsHasThree) {
  FrameSpec frame = GoodFrame();
  proto::FrameSpec message;
  Write(frame, message);
  EXPECT_EQ(ReadFrameSpec(message).value(), frame);
  message.clear_cryptomatte_levels();
  frame.cryptomatte_levels = 3;
  EXPECT_EQ(ReadFrameSpec(message).value(), frame);
}

// They are written, and a coordinator keeps the picture in memory.
TEST(Convert, RanksOfIdsCountForTheMemoryOfAFrame) {
  FrameSpec frame = GoodFrame();
  frame.denoiser = Denoiser::kNone;
  for (const char* name : {"CryptoObject", "CryptoMaterial", "CryptoAsset"})
    AddChannel(frame.channels, {name, ChannelType::kIds, MergeRule::kIdWeights});
  frame.tile_size = 64;
  frame.crop = {0, 0, 6000, 6000};
  frame.width = frame.height = 6000;
  for (const uint32_t levels : {1u, kCryptomatteLevelsMax}) {
    frame.cryptomatte_levels = levels;
    proto::FrameSpec message;
    Write(frame, message);
    EXPECT_EQ(ReadFrameSpec(message).has_value(), levels == 1) << levels;
  }
}

}  // namespace
}  // namespace tessera
