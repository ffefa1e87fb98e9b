// Compressions, layouts, header attributes and previews of picture files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr ExrCompression kAllCompressions[] = {
    ExrCompression::kNone, ExrCompression::kRle,   ExrCompression::kZips, ExrCompression::kZip,
    ExrCompression::kPiz,  ExrCompression::kPxr24, ExrCompression::kB44,  ExrCompression::kB44a,
    ExrCompression::kDwaa, ExrCompression::kDwab};

// More than one tile and one block of lines each way, with a window that starts elsewhere than at 0.
FrameSpec WideSpec() {
  FrameSpec spec;
  spec.width = 200;
  spec.height = 150;
  spec.crop = {5, 7, 196, 141};
  spec.samples_per_pixel = 4;
  spec.attributes = {{"tessera:seed", "17"}};
  return spec;
}

// Values like those of a picture, with exact ones of all magnitudes in the channels that must stay exact.
FramePicture Noise(const FrameSpec& spec) {
  FramePicture picture{spec.crop, {}, {}};
  std::mt19937 random(7);
  const std::vector<PictureChannel> channels = spec.PictureChannels();
  for (const PictureChannel& channel : channels) picture.channels.push_back(channel.name);
  for (int64_t pixel = 0; pixel < spec.crop.area(); ++pixel) {
    for (const PictureChannel& channel : channels) {
      const float value = static_cast<float>(random()) / 4e9f;
      picture.values.push_back(channel.is_exact ? value * std::exp2(static_cast<float>(random() % 100) - 50)
                                                : value);
    }
  }
  return picture;
}

// The file of the farm, written again.
std::string EncodedAs(const ExrFormat& format, const FrameSpec& spec, const FramePicture& picture) {
  return EncodeExr(DecodeExr(EncodeExr(spec, picture).value(), "farm.exr").value(), format).value();
}

std::map<std::string, std::vector<float>> Planes(const LoadedPicture& picture) {
  std::map<std::string, std::vector<float>> planes;
  for (size_t i = 0; i < picture.values.size(); ++i)
    planes[picture.channels[i % picture.channels.size()]].push_back(picture.values[i]);
  return planes;
}

TEST(PictureFormat, EveryCompressionAndLayoutComesBack) {
  for (const ExrCompression compression : kAllCompressions) {
    for (const bool is_tiled : {false, true}) {
      FrameSpec spec = WideSpec();
      spec.exr_type = ExrType::kFloat;
      const ExrFormat format{compression, is_tiled, false};
      const FramePicture picture = Noise(spec);
      const std::string bytes = EncodedAs(format, spec, picture);
      EXPECT_TRUE(bytes == EncodedAs(format, spec, picture)) << "equal pictures give equal bytes";
      const auto loaded = DecodeExr(bytes, "a.exr");
      ASSERT_TRUE(loaded) << loaded.error().message;
      EXPECT_EQ(loaded->format, format);
      EXPECT_EQ(loaded->bounds, spec.crop);
      const auto planes = Planes(*loaded);
      for (size_t c = 0; c < 3; ++c) {
        const std::string& name = picture.channels[c];
        const std::vector<float> expected = picture.Channel(name), found = planes.at(name);
        if (!MayChange(compression, name, ExrType::kFloat)) {
          EXPECT_TRUE(found == expected) << NameOf(compression) << " " << name;
          continue;
        }
        double error = 0;
        for (size_t i = 0; i < found.size(); ++i) error += std::abs(found[i] - expected[i]);
        EXPECT_LT(error / static_cast<double>(found.size()), 0.2) << NameOf(compression);
      }
    }
  }
}

// Of a frame with ids, depth and a channel that looks like luminance to the compression.
TEST(PictureFormat, OnlyWhatACompressionMayChangeChanges) {
  FrameSpec spec = WideSpec();
  AddChannel(spec.channels, {"CryptoObject", ChannelType::kIds, MergeRule::kIdWeights});
  AddChannel(spec.channels, {"Z", ChannelType::kDepth, MergeRule::kNearest});
  AddChannel(spec.channels, {"N.Y", ChannelType::kFloat, MergeRule::kSum});
  const FramePicture picture = Noise(spec);
  const auto before = Planes(*DecodeExr(*EncodeExr(spec, picture), "farm.exr"));
  std::map<ExrCompression, int> changed;
  for (const ExrCompression compression : kAllCompressions) {
    const auto after = Planes(*DecodeExr(EncodedAs({compression, false, false}, spec, picture), "a.exr"));
    for (const PictureChannel& channel : spec.PictureChannels()) {
      const bool is_same = after.at(channel.name) == before.at(channel.name);
      const ExrType type = channel.is_exact ? ExrType::kFloat : ExrType::kHalf;
      if (!MayChange(compression, channel.name, type)) {
        EXPECT_TRUE(is_same) << NameOf(compression) << " " << channel.name;
      }
      changed[compression] += is_same ? 0 : 1;
    }
  }
  EXPECT_EQ(changed[ExrCompression::kZip], 0);
  EXPECT_GT(changed[ExrCompression::kPxr24], 0) << "what may change does, too";
  EXPECT_GT(changed[ExrCompression::kB44], 0);
  EXPECT_GT(changed[ExrCompression::kDwaa], 3) << "ids among them";
}

TEST(PictureFormat, ANameStandsForEachCompression) {
  for (const std::string_view name : ExrCompressionNames()) EXPECT_EQ(NameOf(*ExrCompressionOf(name)), name);
  EXPECT_EQ(ExrCompressionOf("zlib"), std::nullopt);
}

TEST(PictureFormat, AttributesAreWrittenAsTheirTypeAndComeBackAsText) {
  FrameSpec spec = WideSpec();
  spec.attributes = {{"worldToCamera", "1 0 0 0 0 1 0 0 0 0 1 0 -0.1 2.5 3e-20 1"},
                     {"frame", "-7"},
                     {"framesPerSecond", "24000/1001"},
                     {"timeCode", "01:02:03:23"},
                     {"pixelAspectRatio", "1.3333334"},
                     {"software", "Tessera"}};
  const std::string bytes = *EncodeExr(spec, Noise(spec));
  const auto loaded = DecodeExr(bytes, "a.exr");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->attributes, spec.attributes);
  const auto header = ReadExrHeader(bytes, "a.exr");
  ASSERT_TRUE(header) << header.error().message;
  std::map<std::string, std::string> types;
  for (const auto& attribute : header->attributes) types[attribute.name] = attribute.type;
  EXPECT_EQ(types["worldToCamera"], "m44f");
  EXPECT_EQ(types["frame"], "int");
  EXPECT_EQ(types["framesPerSecond"], "rational");
  EXPECT_EQ(types["timeCode"], "timecode");
  EXPECT_EQ(types["pixelAspectRatio"], "float");
  EXPECT_EQ(types["software"], "string");
}

TEST(PictureFormat, AttributesOfTheWrongTypeAreRefused) {
  const std::pair<const char*, const char*> cases[] = {{"worldToCamera", "1 0 0"},
                                                       {"worldToCamera", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1"},
                                                       {"worldToNDC", "nan 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"},
                                                       {"worldToNDC", ""},
                                                       {"frame", "1.5"},
                                                       {"frame", "99999999999"},
                                                       {"framesPerSecond", "24"},
                                                       {"framesPerSecond", "24/0"},
                                                       {"framesPerSecond", "24/-1"},
                                                       {"timeCode", "24:00:00:00"},
                                                       {"timeCode", "1:2:3"},
                                                       {"pixelAspectRatio", "0"},
                                                       {"pixelAspectRatio", "inf"}};
  for (const auto& [name, text] : cases) {
    FrameSpec spec = WideSpec();
    spec.attributes = {{name, text}};
    const auto checked = spec.Check();
    ASSERT_FALSE(checked) << name << " " << text;
    EXPECT_THAT(checked.error().message, HasSubstr(name));
  }
}

TEST(PictureFormat, APreviewShowsTheColoursOfALargePicture) {
  FrameSpec spec = WideSpec();
  FramePicture picture = Noise(spec);
  for (size_t i = 0; i < picture.values.size(); ++i)
    picture.values[i] = i % 3 == 0 ? 1.0f : i % 3 == 1 ? 0.2158605f : -3.0f;
  const std::string bytes = EncodedAs({ExrCompression::kZip, false, true}, spec, picture);
  const auto header = ReadExrHeader(bytes, "a.exr");
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->preview_width, 96);
  EXPECT_EQ(header->preview_height, 96 * spec.crop.height() / spec.crop.width());
  // sRGB of 1, 0.2158605 and below 0, opaque.
  const std::string pixel("\xff\x80\x00\xff", 4);
  EXPECT_NE(bytes.find(pixel + pixel + pixel), std::string::npos);
}

TEST(PictureFormat, ASmallPictureNeedsNoPreview) {
  FrameSpec spec = WideSpec();
  spec.crop = {0, 0, 96, 20};
  EXPECT_TRUE(EncodedAs({ExrCompression::kZip, false, true}, spec, Noise(spec)) ==
              *EncodeExr(spec, Noise(spec)));
}

TEST(PictureFormat, APictureThatWasReadIsWrittenAsItWas) {
  FrameSpec spec = WideSpec();
  AddChannel(spec.channels, {"Z", ChannelType::kDepth, MergeRule::kNearest});
  spec.attributes["worldToCamera"] = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  const std::string bytes = EncodedAs({ExrCompression::kPiz, true, true}, spec, Noise(spec));
  const LoadedPicture loaded = *DecodeExr(bytes, "a.exr");
  EXPECT_TRUE(*EncodeExr(loaded, loaded.format) == bytes);
  LoadedPicture torn = loaded;
  torn.values.pop_back();
  EXPECT_FALSE(EncodeExr(torn, loaded.format));
  LoadedPicture misnamed = loaded;
  misnamed.attributes["frame"] = "x";
  EXPECT_FALSE(EncodeExr(misnamed, loaded.format));
}

TEST(PictureFormat, HeadersOfDamagedFilesAreRefusedOrReadButNeverCrash) {
  FrameSpec spec = WideSpec();
  spec.attributes["timeCode"] = "00:00:00:01";
  spec.attributes["worldToCamera"] = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  const std::string bytes = EncodedAs({ExrCompression::kPiz, true, true}, spec, Noise(spec));
  int read = 0;
  for (size_t i = 0; i < 900; ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0xff);
    read += ReadExrHeader(damaged, "a.exr") ? 1 : 0;
    if (i % 8 == 0) {
      EXPECT_FALSE(ReadExrHeader(bytes.substr(0, i), "a.exr")) << i;
    }
  }
  EXPECT_GT(read, 0);
  EXPECT_LT(read, 900);
}

}  // namespace
}  // namespace tessera
