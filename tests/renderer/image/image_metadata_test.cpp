// What files say about their pixels besides their values.
#include <gtest/gtest.h>
#include <zlib.h>

#include "renderer/image/image.h"
#include "tests/renderer/exr_bytes.h"
#include "tests/renderer/image/encoded_images.h"

namespace tessera::image_metadata {
namespace {

std::string PngChunk(const std::string& type, const std::string& data) {
  const std::string both = type + data;
  const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(both.data()), static_cast<uInt>(both.size()));
  return BigEndian32(static_cast<uint32_t>(data.size())) + both +
         BigEndian32(static_cast<uint32_t>(checksum));
}

enum class PngColor : char { kGrey = 0, kRgb = 2, kPalette = 3, kGreyAlpha = 4, kRgba = 6 };

// One row of pixels of 8 bits; `chunks` stand before the pixels.
std::string PngRow(PngColor color, int width, const std::string& chunks, const std::string& pixels) {
  const std::string row = '\0' + pixels;  // the filter of the row: none
  std::string packed(compressBound(row.size()), '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(row.data()),
           row.size());
  packed.resize(size);
  const std::string header = BigEndian32(static_cast<uint32_t>(width)) + BigEndian32(1) + '\x08' +
                             static_cast<char>(color) + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + PngChunk("IHDR", header) + chunks + PngChunk("IDAT", packed) +
         PngChunk("IEND", "");
}

const std::string kTwoColors = "\x10\x40\xa0\xf0\x08\x20";

TEST(OpenExrMetadata, ChromaticitiesAreReadAndOtherwiseAbsent) {
  const std::vector<float> rgb{.25f, .5f, .75f};
  EXPECT_EQ(Decoded(ExrOf(1, 1, rgb), "a.exr").chromaticities, std::nullopt);
  const Image image = Decoded(ExrOf(1, 1, rgb, ExrChromaticities(kRec2020Xy)), "a.exr");
  const Chromaticities rec2020{{.708f, .292f}, {.17f, .797f}, {.131f, .046f}, {.3127f, .329f}};
  EXPECT_EQ(image.chromaticities, rec2020);
  for (int c = 0; c < 3; ++c)
    EXPECT_EQ(image.Get(0, 0, image.ChannelIndex(std::string(1, "RGB"[c]))), rgb[c]);
}

TEST(PngMetadata, GammaAndColorSpaceChunksChangeNothingAsInPbrt) {
  const Image plain = Decoded(PngRow(PngColor::kRgb, 2, "", kTwoColors), "a.png");
  const std::string gamma = PngChunk("gAMA", BigEndian32(100000)),
                    srgb = PngChunk("sRGB", std::string(1, '\0'));
  std::string wide;
  for (const uint32_t v : {31270u, 32900u, 70800u, 29200u, 17000u, 79700u, 13100u, 4600u})
    wide += BigEndian32(v);
  for (const std::string& chunks : {gamma, srgb, PngChunk("cHRM", wide), gamma + PngChunk("cHRM", wide)}) {
    const Image image = Decoded(PngRow(PngColor::kRgb, 2, chunks, kTwoColors), "a.png");
    EXPECT_EQ(image.bytes, plain.bytes);
    EXPECT_EQ(image.encoding, plain.encoding);
    EXPECT_EQ(image.chromaticities, std::nullopt);
  }
}

TEST(PngMetadata, OnlyPixelsOfFourValuesHaveAlphaAsInPbrt) {
  const Image plain = Decoded(PngRow(PngColor::kRgb, 2, "", kTwoColors), "a.png");
  const std::string transparent_palette = PngChunk("PLTE", kTwoColors) + PngChunk("tRNS", "\x40");
  const std::string transparent_color = PngChunk("tRNS", std::string("\0\x10\0\x40\0\xa0", 6));
  for (const std::string& file : {PngRow(PngColor::kPalette, 2, transparent_palette, std::string("\0\1", 2)),
                                  PngRow(PngColor::kRgb, 2, transparent_color, kTwoColors)}) {
    const Image image = Decoded(file, "a.png");
    EXPECT_EQ(image.channel_names, plain.channel_names);
    EXPECT_EQ(image.bytes, plain.bytes);
  }
  const Image grey =
      Decoded(PngRow(PngColor::kGrey, 2, PngChunk("tRNS", std::string("\0\x20", 2)), "\x20\x70"), "a.png");
  EXPECT_EQ(grey.channel_names, std::vector<std::string>{"Y"});
  EXPECT_EQ(grey.bytes, (std::vector<uint8_t>{0x20, 0x70}));
  const Image rgba = Decoded(PngRow(PngColor::kRgba, 1, "", "\x10\x40\xa0\x80"), "a.png");
  EXPECT_EQ(rgba.bytes, (std::vector<uint8_t>{0x10, 0x40, 0xa0, 0x80}));
}

// A Radiance picture of 3 x 2 pixels whose stored pixels are 1, 2, ... 6.
std::string Radiance(const std::string& resolution, const std::string& header = "") {
  std::string file = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + header + "\n" + resolution + "\n";
  for (int i = 1; i <= 6; ++i) file += {static_cast<char>(16 * i), static_cast<char>(16 * i), '\0', '\x84'};
  return file;
}

TEST(RadianceMetadata, PicturesOfAllEightOrientationsBecomeUpright) {
  struct Case {
    std::string resolution;
    std::vector<float> rows;  // of the upright picture
  };
  const std::vector<Case> cases{{"-Y 2 +X 3", {1, 2, 3, 4, 5, 6}}, {"-Y 2 -X 3", {3, 2, 1, 6, 5, 4}},
                                {"+Y 2 +X 3", {4, 5, 6, 1, 2, 3}}, {"+Y 2 -X 3", {6, 5, 4, 3, 2, 1}},
                                {"+X 3 -Y 2", {1, 3, 5, 2, 4, 6}}, {"+X 3 +Y 2", {2, 4, 6, 1, 3, 5}},
                                {"-X 3 -Y 2", {5, 3, 1, 6, 4, 2}}, {"-X 3 +Y 2", {6, 4, 2, 5, 3, 1}}};
  for (const Case& c : cases) {
    const Image image = Decoded(Radiance(c.resolution), "a.hdr");
    ASSERT_EQ(image.width, 3) << c.resolution;
    ASSERT_EQ(image.height, 2) << c.resolution;
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(image.Get(i % 3, i / 3, 0), c.rows[i]) << c.resolution << " pixel " << i;
      EXPECT_EQ(image.Get(i % 3, i / 3, 2), 0) << c.resolution << " pixel " << i;
    }
  }
}

TEST(RadianceMetadata, ExposureGammaAndPrimariesChangeNothingAsInPbrt) {
  const std::string header =
      "EXPOSURE=4\nGAMMA=2.2\nCOLORCORR=1 2 3\nPRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\n";
  const Image plain = Decoded(Radiance("-Y 2 +X 3"), "a.hdr");
  EXPECT_EQ(Decoded(Radiance("-Y 2 +X 3", header), "a.hdr").bytes, plain.bytes);
}

// A TIFF of 2 x 1 pixels with the values 10 and 200 and this value of its tag "Orientation".
std::string TiffOf(int orientation) {
  OIIO::ImageSpec spec(2, 1, 1, OIIO::TypeDesc::UINT8);
  spec.attribute("Orientation", orientation);
  std::vector<unsigned char> file;
  OIIO::Filesystem::IOVecOutput proxy(file);
  auto output = OIIO::ImageOutput::create("tiff");
  const uint8_t values[2] = {10, 200};
  if (!output->set_ioproxy(&proxy) || !output->open("a.tif", spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, values)) {
    ADD_FAILURE() << output->geterror();
  }
  output->close();
  return {file.begin(), file.end()};
}

TEST(TiffMetadata, PicturesBecomeUpright) {
  const std::vector<uint8_t> forwards{10, 200}, backwards{200, 10};
  for (const int orientation : {1, 2, 3, 4}) {
    const Image image = Decoded(TiffOf(orientation), "a.tif");
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.bytes, orientation == 2 || orientation == 3 ? backwards : forwards) << orientation;
  }
  for (const int orientation : {5, 6, 7, 8}) {
    const Image image = Decoded(TiffOf(orientation), "a.tif");
    EXPECT_EQ(image.height, 2);
    EXPECT_EQ(image.bytes, orientation == 7 || orientation == 8 ? backwards : forwards) << orientation;
  }
}

}  // namespace
}  // namespace tessera::image_metadata
