#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/image/image.h"
#include "renderer/util/file.h"
#include "tests/build_paths.h"
#include "tests/renderer/image/encoded_images.h"

namespace tessera {
namespace {

constexpr ColorEncoding kLinear{ColorEncoding::Kind::kLinear, 1};
// Pictures of others, beside the source tree or where TESSERA_SHARED says; tests without them skip
// themselves.
std::filesystem::path SharedFolder() {
  const char* shared = std::getenv("TESSERA_SHARED");
  if (shared != nullptr) return shared;
  return std::filesystem::path(SourceDir()).parent_path() / "shared";
}

const std::filesystem::path kCorpus = SharedFolder() / "corpora/images/png-corpus";

TEST(ColorEncoding, FollowsTheStandardCurves) {
  const ColorEncoding srgb{ColorEncoding::Kind::kSrgb, 1};
  EXPECT_EQ(srgb.ToLinear(0), 0);
  EXPECT_NEAR(srgb.ToLinear(1), 1, 1e-6f);
  EXPECT_NEAR(srgb.ToLinear(0.5f), 0.2140411f, 1e-6f);
  EXPECT_NEAR(srgb.ToLinear(10 / 255.0f), 10 / 255.0f / 12.92f, 1e-7f);
  EXPECT_EQ(kLinear.ToLinear(0.3f), 0.3f);
  EXPECT_NEAR((ColorEncoding{ColorEncoding::Kind::kGamma, 2.2f}.ToLinear(0.5f)), 0.2176376f, 1e-6f);
}

TEST(DecodeImage, EightBitValuesStayAsTheyAreInLosslessFormats) {
  const int width = 9, height = 5;
  for (const auto& [plugin, channels] : std::vector<std::pair<std::string, int>>{{"png", 1},
                                                                                 {"png", 2},
                                                                                 {"png", 3},
                                                                                 {"png", 4},
                                                                                 {"tiff", 1},
                                                                                 {"tiff", 3},
                                                                                 {"tiff", 4},
                                                                                 {"targa", 3},
                                                                                 {"bmp", 3}}) {
    const std::vector<uint8_t> values = Pattern8(width, height, channels);
    const std::string name = "picture." + (plugin == "targa" ? "tga" : plugin);
    const Image image = Decoded(Encode(plugin, width, height, channels, values), name);
    EXPECT_EQ(image.width, width) << name;
    EXPECT_EQ(image.height, height) << name;
    EXPECT_EQ(image.channels, channels) << name;
    EXPECT_EQ(image.format, PixelFormat::kUint8) << name;
    EXPECT_EQ(image.encoding.kind, ColorEncoding::Kind::kSrgb) << name;
    EXPECT_EQ(image.bytes, values) << name << " with " << channels << " channels";
  }
}

TEST(DecodeImage, ChannelsHaveTheNamesOfTheirMeaning) {
  using testing::ElementsAre;
  const auto names = [](int channels) {
    return Decoded(Encode("png", 2, 2, channels, Pattern8(2, 2, channels)), "a.png").channel_names;
  };
  EXPECT_THAT(names(1), ElementsAre("Y"));
  EXPECT_THAT(names(2), ElementsAre("Y", "A"));
  EXPECT_THAT(names(3), ElementsAre("R", "G", "B"));
  EXPECT_THAT(names(4), ElementsAre("R", "G", "B", "A"));
}

TEST(DecodeImage, PicturesOfManyRowsAreReadWhole) {
  const int height = 6001;
  const std::vector<uint8_t> pixels = Pattern8(3, height, 3);
  for (const char* plugin : {"png", "tiff", "targa", "bmp"}) {
    const std::string name = std::string("a.") + (plugin == std::string("targa")  ? "tga"
                                                  : plugin == std::string("tiff") ? "tif"
                                                                                  : plugin);
    EXPECT_EQ(Decoded(Encode(plugin, 3, height, 3, pixels), name).bytes, pixels) << name;
  }
}

TEST(DecodeImage, TransparentTargaAndBmpLoseTheirAlphaButNotTheirColor) {
  const std::vector<uint8_t> rgba{200, 100, 50, 128, 10, 20, 30, 0};
  const std::vector<uint8_t> rgb{200, 100, 50, 10, 20, 30};
  EXPECT_EQ(Decoded(Encode("targa", 2, 1, 4, rgba), "a.tga").bytes, rgb);
  EXPECT_EQ(Decoded(Encode("bmp", 2, 1, 4, rgba), "a.bmp").bytes, rgb);
}

TEST(DecodeImage, LossyFormatsAreReadCloseToWhatWasWritten) {
  for (const auto& [plugin, channels] :
       std::vector<std::pair<std::string, int>>{{"jpeg", 1}, {"jpeg", 3}, {"webp", 3}}) {
    const Image image =
        Decoded(Encode(plugin, 8, 8, channels, std::vector<uint8_t>(64 * channels, 180)), "picture");
    EXPECT_EQ(image.channels, channels);
    EXPECT_EQ(image.bytes.size(), 64u * channels);
    for (const uint8_t v : image.bytes) EXPECT_NEAR(v, 180, 3) << plugin;
  }
}

TEST(DecodeImage, SixteenBitPngBecomesLinearHalf) {
  const std::vector<uint16_t> values{0, 32768, 65535, 1000};
  const Image image = Decoded(Encode("png", 2, 2, 1, values), "a.png");
  EXPECT_EQ(image.format, PixelFormat::kHalf);
  EXPECT_EQ(image.Get(0, 0, 0), 0);
  EXPECT_NEAR(image.Get(1, 0, 0), 0.2140569f, 2e-4f);
  EXPECT_EQ(image.Get(0, 1, 0), 1);
  const Image linear = Decoded(Encode("png", 2, 2, 1, values), "a.png", kLinear);
  EXPECT_NEAR(linear.Get(1, 0, 0), 0.5f, 3e-4f);
}

TEST(DecodeImage, FloatFormatsKeepTheirValues) {
  const int width = 6, height = 4;
  const std::vector<float> values = PatternFloat(width, height, 3);
  for (const std::string& file :
       {Encode("openexr", width, height, 3, values), EncodePfm(width, height, 3, values)}) {
    const Image image = Decoded(file, file.starts_with("PF") ? "a.pfm" : "a.exr");
    ASSERT_EQ(image.channels, 3);
    for (int i = 0; i < width * height * 3; ++i) {
      EXPECT_NEAR(image.Get(i / 3 % width, i / 3 / width, i % 3), values[i], 1e-3f) << i;
    }
  }
}

TEST(DecodeImage, RadianceFilesAreReadWithinTheirSharedExponent) {
  const std::vector<float> values = PatternFloat(16, 4, 3);
  const Image image = Decoded(Encode("hdr", 16, 4, 3, values), "a.hdr");
  EXPECT_EQ(image.format, PixelFormat::kFloat);
  for (int i = 0; i < 16 * 4 * 3; ++i)
    EXPECT_NEAR(image.Get(i / 3 % 16, i / 48, i % 3), values[i], 8.0f / 256) << i;
}

TEST(DecodeImage, HalfOpenExrStaysHalf) {
  OIIO::ImageSpec spec(2, 1, 1, OIIO::TypeDesc::HALF);
  std::vector<unsigned char> file;
  OIIO::Filesystem::IOVecOutput proxy(file);
  auto output = OIIO::ImageOutput::create("openexr");
  output->set_ioproxy(&proxy);
  ASSERT_TRUE(output->open("a.exr", spec));
  const float values[2] = {0.25f, 1024};
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values));
  output->close();
  const Image image = Decoded({file.begin(), file.end()}, "a.exr");
  EXPECT_EQ(image.format, PixelFormat::kHalf);
  EXPECT_EQ(image.Get(1, 0, 0), 1024);
  EXPECT_EQ(image.channel_names, std::vector<std::string>{"Y"});
}

TEST(DecodeImage, PortableFloatMapOfTheOtherByteOrderAndScaleIsRead) {
  std::string file = "Pf\n1 2\n2.0\n";
  file += BigEndian32(0x3f800000) + BigEndian32(0x40400000);  // 1 below, 3 above
  const Image image = Decoded(file, "a.pfm");
  EXPECT_EQ(image.Get(0, 0, 0), 6);
  EXPECT_EQ(image.Get(0, 1, 0), 2);
}

TEST(DecodeImage, QoiChunksOfEveryKindAreRead) {
  std::string file = "qoif" + BigEndian32(8) + BigEndian32(1) + std::string("\x04\x01", 2);
  file += "\xfe\x10\x20\x30";      // rgb
  file += "\x7f";                  // +1 +1 +1
  file += "\xa5\x9c";              // green +5, red +5+1, blue +5+4
  file += "\xff\x01\x02\x03\x04";  // rgba
  file += "\xc1";                  // twice more
  file += static_cast<char>((0x10 * 3 + 0x20 * 5 + 0x30 * 7 + 255 * 11) % 64);  // the first again
  file += '\x00';  // a place not yet seen: transparent black
  file += std::string(7, '\0') + '\x01';
  const Image image = Decoded(file, "a.qoi");
  const std::vector<uint8_t> expected{0x10, 0x20, 0x30, 255,  0x11, 0x21, 0x31, 255, 0x17, 0x26, 0x3a,
                                      255,  1,    2,    3,    4,    1,    2,    3,   4,    1,    2,
                                      3,    4,    0x10, 0x20, 0x30, 255,  0,    0,   0,    0};
  EXPECT_EQ(image.bytes, expected);
  EXPECT_EQ(image.encoding.kind, ColorEncoding::Kind::kLinear);
}

TEST(DecodeImage, ContentDecidesUnlessTheEndingNamesAnotherFormat) {
  const std::string png = Encode("png", 2, 2, 3, Pattern8(2, 2, 3));
  EXPECT_EQ(Decoded(png, "picture").width, 2);
  EXPECT_EQ(Decoded(png, "picture.tga").width, 2);
  EXPECT_EQ(ErrorOf(png, "picture.exr"), "picture.exr: holds a PNG picture, but its name says OpenEXR");
}

TEST(DecodeImage, WhatIsNotAPictureIsRefusedByName) {
  EXPECT_EQ(ErrorOf("", "a.png"), "a.png: the file is empty, expected a picture");
  EXPECT_EQ(ErrorOf("hello, world", "a.png"), "a.png: damaged picture: it does not begin as a PNG file does");
  EXPECT_EQ(ErrorOf("hello, world", "notes.txt"),
            "notes.txt: not a picture of a known format, expected EXR, PNG, JPEG, TGA, HDR, TIFF, BMP, WebP, "
            "PFM or QOI");
  EXPECT_EQ(ErrorOf("Pf\n4 4\n-1\nabc", "a.pfm"),
            "a.pfm: damaged picture: it ends after 13 bytes, 74 were expected");
}

TEST(DecodeImage, SizesBeyondTheLimitsAreRefusedBeforeMemoryIsAskedFor) {
  EXPECT_THAT(ErrorOf("Pf\n100000 1\n-1\n", "a.pfm"), testing::HasSubstr("picture too large: 100000x1"));
  EXPECT_THAT(ErrorOf("PF\n60000 60000\n-1\n", "a.pfm"), testing::HasSubstr("picture too large"));
  EXPECT_THAT(ErrorOf("Pf\n-3 4\n-1\n", "a.pfm"), testing::HasSubstr("its size is -3x4"));
  // Within the absolute limit, but a run this short cannot describe this number of pixels.
  const std::string bomb =
      "qoif" + BigEndian32(20000) + BigEndian32(20000) + std::string("\x03\x00", 2) + "\xfd";
  EXPECT_EQ(ErrorOf(bomb, "a.qoi"), "a.qoi: damaged picture: 15 bytes cannot hold 20000x20000 pixels");
}

TEST(DecodeImage, APngThatStartsWithAnotherChunkIsDamagedAndDeclaresNoSize) {
  const std::string chunk =
      BigEndian32(4) + "CgBI" + std::string("\x50\x00\x20\x06", 4) + BigEndian32(0x2bd53f7f);
  EXPECT_THAT(ErrorOf("\x89PNG\r\n\x1a\n" + chunk, "a.png"), testing::StartsWith("a.png: damaged "));
}

TEST(DecodeImage, TheReferencePngFilesGiveTheReferencePixels) {
  if (!std::filesystem::exists(kCorpus)) GTEST_SKIP() << "no corpus";
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kCorpus / "primary")) {
    const std::string check = kCorpus / "primary_check" / entry.path().filename();
    const Image image = Decoded(*ReadFile(entry.path(), 1 << 20), entry.path());
    const Image expected = Decoded(*ReadFile(check, 1 << 20), check);
    ASSERT_EQ(image.width, expected.width);
    ASSERT_EQ(image.height, expected.height);
    // The reference files are RGB or RGBA throughout.
    const int grey = image.ChannelIndex("Y"), alpha = image.ChannelIndex("A");
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        if (alpha >= 0 && image.Get(x, y, alpha) == 0) continue;  // its colour does not matter
        for (int c = 0; c < 3; ++c) {
          ASSERT_EQ(image.Get(x, y, grey >= 0 ? grey : c), expected.Get(x, y, expected.channels > 2 ? c : 0))
              << entry.path() << " " << x << " " << y;
        }
      }
    }
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

TEST(DecodeImage, EveryDamagedPngOfTheCorpusIsRefusedInOneLineThatNamesIt) {
  if (!std::filesystem::exists(kCorpus)) GTEST_SKIP() << "no corpus";
  for (const std::string folder : {"corrupt", "iphone"}) {
    for (const auto& entry : std::filesystem::directory_iterator(kCorpus / folder)) {
      const std::string name = entry.path().filename();
      testing::internal::CaptureStderr();
      const std::string message = ErrorOf(*ReadFile(entry.path(), 1 << 20), name);
      EXPECT_THAT(message, testing::StartsWith(name + ": damaged "));
      EXPECT_THAT(message, testing::Not(testing::HasSubstr("\n")));
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
    }
  }
}

}  // namespace
}  // namespace tessera
