// Small files that announce large pictures: refused before a library sees them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/exr/exr_header.h"
#include "renderer/image/declared_size.h"
#include "renderer/image/image.h"
#include "tests/renderer/exr_bytes.h"
#include "tests/renderer/image/encoded_images.h"

namespace tessera::image_bombs {
namespace {

using testing::HasSubstr;

TEST(ExrBomb, WholeFilesPass) {
  const std::vector<float> values = PatternFloat(24, 10, 3);
  for (const std::string& file :
       {ExrOf(2, 2, std::vector<float>(12, 1)), Encode("openexr", 24, 10, 3, values)}) {
    EXPECT_EQ(ErrorOf(file, "a.exr"), "no error");
  }
}

TEST(ExrBomb, AttributesLieWithinTheFile) {
  for (const uint32_t size : {1000u, 0x10000000u, 0x7fffffffu, 0xffffffffu}) {
    const std::string attribute = std::string("huge") + '\0' + "string" + '\0' + LittleEndian32(size) + "abc";
    const std::string file = ExrHeader(2, 2, "BGR", attribute);
    EXPECT_EQ(ErrorOf(file, "a.exr"), "a.exr: damaged OpenEXR picture: the attribute \"huge\" has " +
                                          std::to_string(size) + " bytes, more than the file");
  }
}

// OpenEXR reads as many bytes as the type has, so that a wrong size would move the attributes that follow.
TEST(ExrBomb, AttributesHaveTheSizeOfTheirType) {
  const std::string text = LittleEndian32(2) + "ab";
  const std::string pixel = LittleEndian32(1) + LittleEndian32(1) + "rgba";
  const std::vector<std::pair<std::string, std::string>> valid = {{"float", "1234"},
                                                                  {"box2i", std::string(16, '\1')},
                                                                  {"v3f", std::string(12, '\1')},
                                                                  {"chlist", std::string(1, '\0')},
                                                                  {"stringvector", text + text},
                                                                  {"preview", pixel},
                                                                  {"string", ""},
                                                                  {"unknown", "any"}};
  for (const auto& [type, value] : valid)
    EXPECT_EQ(ErrorOf(ExrOf(1, 1, {1, 1, 1}, ExrAttribute("extra", type, value)), "a.exr"), "no error")
        << type;
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"float", "12345"},
      {"box2i", "1"},
      {"v3f", std::string(8, '\1')},
      {"chlist", std::string(2, '\0')},
      {"chlist", "R"},
      {"stringvector", text + LittleEndian32(0x70000000)},
      {"stringvector", "ab"},
      {"preview", pixel + "a"},
      {"preview", LittleEndian32(0x10000) + LittleEndian32(0x10000)}};
  for (const auto& [type, value] : wrong) {
    EXPECT_EQ(ErrorOf(ExrOf(1, 1, {1, 1, 1}, ExrAttribute("extra", type, value)), "a.exr"),
              "a.exr: damaged OpenEXR picture: the attribute \"extra\" has " + std::to_string(value.size()) +
                  " bytes, which is not the size of its type")
        << type;
  }
}

TEST(ExrBomb, HeadersAreBounded) {
  const std::string file =
      ExrOf(1, 1, {1, 1, 1}, ExrAttribute("large", "string", std::string(kExrHeaderSizeMax + 1, 'x')));
  EXPECT_EQ(ErrorOf(file, "a.exr"), "a.exr: damaged OpenEXR picture: the header is too large");
}

TEST(ExrBomb, WindowsAndTilesAreComparedWithTheFile) {
  EXPECT_THAT(ErrorOf(ExrHeader(0x7fffffff, 1, "BGR", ""), "a.exr"), HasSubstr("picture too large"));
  EXPECT_THAT(ErrorOf(ExrHeader(1, 0x7fffffff, "BGR", ""), "a.exr"), HasSubstr("picture too large"));
  EXPECT_THAT(ErrorOf(ExrHeader(60000, 15000, "BGR", ""), "a.exr"), HasSubstr("picture too large"));
  EXPECT_THAT(ErrorOf(ExrHeader(20000, 15000, "BGR", ""), "a.exr"),
              HasSubstr("cannot hold 20000x15000 pixels"));
  const auto tiled = [](uint32_t size) {
    std::string file =
        ExrHeader(1024, 1024, "BGR",
                  ExrAttribute("tiles", "tiledesc", LittleEndian32(size) + LittleEndian32(size) + '\0'));
    file[5] |= 2;  // the flag of tiles
    return file;
  };
  EXPECT_THAT(ErrorOf(tiled(1), "a.exr"), HasSubstr("bytes cannot hold 1048576 blocks of pixels"));
  EXPECT_THAT(ErrorOf(tiled(0), "a.exr"), HasSubstr("its size is 0x0"));
  EXPECT_THAT(ErrorOf(tiled(0x7fffffff), "a.exr"), HasSubstr("picture too large"));
  EXPECT_THAT(ErrorOf(tiled(16000), "a.exr"), HasSubstr("cannot hold 16000x16000 pixels"));
}

TEST(ExrBomb, DeepPicturesAreRefusedByTheirHeader) {
  std::string file = ExrHeader(2, 2, "BGR", "");
  file[5] |= 8;  // the flag of deep data
  EXPECT_EQ(ErrorOf(file, "a.exr"), "a.exr: deep and volume pictures are not supported");
}

struct Sample {
  ImageFormat format;
  std::string name, plugin;
};
const std::vector<Sample> kSamples{
    {ImageFormat::kPng, "a.png", "png"},   {ImageFormat::kJpeg, "a.jpg", "jpeg"},
    {ImageFormat::kTga, "a.tga", "targa"}, {ImageFormat::kTiff, "a.tif", "tiff"},
    {ImageFormat::kBmp, "a.bmp", "bmp"},   {ImageFormat::kWebp, "a.webp", "webp"}};

TEST(DeclaredSize, IsThatOfThePicture) {
  for (const Sample& sample : kSamples) {
    const auto size = FindDeclaredSize(sample.format, Encode(sample.plugin, 24, 10, 3, Pattern8(24, 10, 3)));
    ASSERT_TRUE(size) << sample.name;
    EXPECT_EQ(size->width, 24) << sample.name;
    EXPECT_EQ(size->height, 10) << sample.name;
  }
  const auto hdr = FindDeclaredSize(ImageFormat::kHdr, Encode("hdr", 24, 10, 3, PatternFloat(24, 10, 3)));
  ASSERT_TRUE(hdr);
  EXPECT_EQ(hdr->width, 24);
  EXPECT_EQ(hdr->height, 10);
}

TEST(DeclaredSize, NoFileIsTooShortToBeRead) {
  for (const Sample& sample : kSamples) {
    const std::string whole = Encode(sample.plugin, 24, 10, 3, Pattern8(24, 10, 3));
    for (size_t size = 0; size < whole.size(); ++size) FindDeclaredSize(sample.format, whole.substr(0, size));
  }
}

// Both sides as large as the field holds.
TEST(DeclaredSize, BeyondTheFileIsRefusedBeforeALibraryAllocates) {
  std::string tga = Encode("targa", 24, 10, 3, Pattern8(24, 10, 3));
  for (const size_t at : {12, 13, 14, 15}) tga[at] = '\xff';
  EXPECT_THAT(ErrorOf(tga, "a.tga"), HasSubstr("picture"));
  std::string bmp = Encode("bmp", 24, 10, 3, Pattern8(24, 10, 3));
  for (const size_t at : {18, 19, 22, 23}) bmp[at] = '\x7f';
  EXPECT_THAT(ErrorOf(bmp, "a.bmp"), HasSubstr("cannot hold 32639x32639 pixels"));
  std::string extended("RIFF\x1e\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\x3f\0\xff\x3f\0", 30);
  EXPECT_THAT(ErrorOf(extended, "a.webp"), HasSubstr("cannot hold 16384x16384 pixels"));
  EXPECT_THAT(ErrorOf("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n", "a.hdr"),
              HasSubstr("picture too large"));
}

}  // namespace
}  // namespace tessera::image_bombs
