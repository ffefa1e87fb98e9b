// Whatever the bytes, decoding ends with a picture that is whole or with one line that names the file.
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "renderer/image/image.h"
#include "tests/renderer/image/encoded_images.h"

namespace tessera {
namespace {

struct Sample {
  std::string name;
  std::string bytes;
};

std::vector<Sample> Samples() {
  const int w = 24, h = 10;
  std::string qoi =
      "qoif" + BigEndian32(3) + BigEndian32(1) + std::string("\x03\x00", 2) + "\xfe\x10\x20\x30\xa5\x9c\x7f";
  return {{"a.png", Encode("png", w, h, 3, Pattern8(w, h, 3))},
          {"b.png", Encode("png", w, h, 1, std::vector<uint16_t>(w * h, 777))},
          {"a.jpg", Encode("jpeg", w, h, 3, Pattern8(w, h, 3))},
          {"a.tga", Encode("targa", w, h, 4, Pattern8(w, h, 4))},
          {"a.bmp", Encode("bmp", w, h, 3, Pattern8(w, h, 3))},
          {"a.tif", Encode("tiff", w, h, 3, Pattern8(w, h, 3))},
          {"a.webp", Encode("webp", w, h, 3, Pattern8(w, h, 3))},
          {"a.hdr", Encode("hdr", w, h, 3, PatternFloat(w, h, 3))},
          {"a.exr", Encode("openexr", w, h, 3, PatternFloat(w, h, 3))},
          {"a.pfm", EncodePfm(w, h, 3, PatternFloat(w, h, 3))},
          {"a.qoi", qoi}};
}

void ExpectWholeOrRefused(const std::string& bytes, const std::string& name, const std::string& what) {
  const Result<Image> image = DecodeImage(bytes, name, {});
  if (!image) {
    EXPECT_THAT(image.error().message, testing::StartsWith(name + ": ")) << what;
    EXPECT_THAT(image.error().message, testing::Not(testing::HasSubstr("\n"))) << what;
    return;
  }
  const size_t value_size = image->format == PixelFormat::kUint8  ? 1
                            : image->format == PixelFormat::kHalf ? 2
                                                                  : 4;
  EXPECT_EQ(image->bytes.size(), value_size * image->width * image->height * image->channels) << what;
  EXPECT_EQ(image->channel_names.size(), static_cast<size_t>(image->channels)) << what;
}

TEST(DamagedImage, TheSamplesThemselvesAreWhole) {
  for (const Sample& sample : Samples()) {
    const Result<Image> image = DecodeImage(sample.bytes, sample.name, {});
    EXPECT_TRUE(image.has_value()) << (image ? "" : image.error().message);
  }
}

TEST(DamagedImage, FilesCutOffAnywhereEndWell) {
  for (const Sample& sample : Samples()) {
    for (size_t size = 0; size < sample.bytes.size(); size += 1 + sample.bytes.size() / 64) {
      ExpectWholeOrRefused(sample.bytes.substr(0, size), sample.name,
                           sample.name + " cut at " + std::to_string(size));
    }
  }
}

TEST(DamagedImage, FilesCutInTheMiddleAreRefused) {
  for (const Sample& sample : Samples()) {
    const Result<Image> image = DecodeImage(sample.bytes.substr(0, sample.bytes.size() / 2), sample.name, {});
    EXPECT_FALSE(image.has_value()) << sample.name;
  }
}

TEST(DamagedImage, ATiffFileWithoutMostOfItsRowsIsRefused) {
  std::string tiff = Encode("tiff", 9, 7, 3, Pattern8(9, 7, 3));
  // The entry of the height: tag 257, type 16-bit, one value.
  const std::string entry("\x01\x01\x03\x00\x01\x00\x00\x00\x07", 9);
  const size_t at = tiff.find(entry);
  ASSERT_NE(at, std::string::npos);
  for (const size_t byte : {8, 9}) tiff[at + byte] = '\xff';
  const Result<Image> image = DecodeImage(tiff, "a.tif", {});
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message, testing::HasSubstr("a.tif: damaged TIFF picture"));
}

// The test pattern of three bytes a pixel, as described by `spec`.
std::string EncodeAs(const char* format, const OIIO::ImageSpec& spec) {
  std::vector<unsigned char> file;
  OIIO::Filesystem::IOVecOutput proxy(file);
  const auto output = OIIO::ImageOutput::create(format);
  output->set_ioproxy(&proxy);
  const std::vector<uint8_t> pixels = Pattern8(spec.width, spec.height, 3);
  EXPECT_TRUE(output->open("a", spec) && output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) &&
              output->close());
  return {file.begin(), file.end()};
}

// A file of 2 x 200 pixels whose first row has this number.
std::string PictureAtRow(const char* format, int row) {
  OIIO::ImageSpec spec(2, 200, 3, OIIO::TypeDesc::UINT8);
  spec.y = row;
  return EncodeAs(format, spec);
}

// The same as a PNG file, also for numbers with which the library writes none.
std::string PngAtRow(int row) {
  std::string png = PictureAtRow("png", 5);
  const size_t chunk =
      png.find("oFFs");  // followed by the number of the first column, that of the row, and a unit
  EXPECT_NE(chunk, std::string::npos);
  const auto write = [&](size_t at, uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) png[at++] = static_cast<char>(value >> shift);
  };
  write(chunk + 8, static_cast<uint32_t>(row));
  write(chunk + 13, static_cast<uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(png.data() + chunk), 13)));
  return png;
}

TEST(DamagedImage, PicturesWhoseRowsHaveNumbersNearTheLargestAreRefused) {
  const auto decoded = [](const char* format, int row) {
    const bool is_png = std::string_view(format) == "png";
    return DecodeImage(is_png ? PngAtRow(row) : PictureAtRow(format, row), std::string("a.") + format, {});
  };
  for (const char* format : {"tiff", "png"}) {
    SCOPED_TRACE(format);
    for (const int row : {5, 1 << 29}) {
      const Result<Image> image = decoded(format, row);
      ASSERT_TRUE(image) << image.error().message;
      EXPECT_EQ(image->bytes, Pattern8(2, 200, 3)) << row;
    }
    // Of a TIFF file they are floats: the last is the largest that is an int.
    for (const int row : {(1 << 30) + (1 << 20), 2'146'697'472, 2'147'483'520}) {
      const Result<Image> image = decoded(format, row);
      ASSERT_FALSE(image) << row;
      EXPECT_THAT(image.error().message, testing::HasSubstr("picture: its position is out of range"));
    }
  }
}

// A TIFF file of 2 x 200 pixels that states this number of rows in a strip, as a number of eight bytes
// outside of the directory if `is_far`. The strips are as the library writes them, of fewer rows or of all.
struct StripOptions {
  uint32_t rows = 0;
  bool is_far = false, is_one_strip = false, is_separate = false;
};
std::string TiffOfStrips(const StripOptions& options) {
  OIIO::ImageSpec spec(2, 200, 3, OIIO::TypeDesc::UINT8);
  if (options.is_one_strip) spec.attribute("tiff:RowsPerStrip", 200);
  if (options.is_separate) spec.attribute("planarconfig", "separate");
  std::string tiff = EncodeAs("tiff", spec);
  const size_t field = tiff.find(std::string("\x16\x01\x03\x00\x01\x00\x00\x00", 8));  // one short integer
  EXPECT_NE(field, std::string::npos);
  const auto write = [&](size_t at, uint32_t value) {
    for (int i = 0; i < 4; ++i) tiff[at + static_cast<size_t>(i)] = static_cast<char>(value >> (8 * i));
  };
  constexpr char kLong = 4, kLong8 = 16;
  tiff[field + 2] = options.is_far ? kLong8 : kLong;
  write(field + 8, options.is_far ? static_cast<uint32_t>(tiff.size()) : options.rows);
  tiff += std::string(8, '\0');
  write(tiff.size() - 8, options.rows);
  return tiff;
}

TEST(DamagedImage, TiffStripsOfMoreRowsThanThePictureHasAreReadOrRefused) {
  for (const uint32_t rows : {200u, 201u, 0x40000001u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    for (int kind = 0; kind < 8; ++kind) {
      const StripOptions options{rows, (kind & 1) != 0, (kind & 2) != 0, (kind & 4) != 0};
      const Result<Image> image = DecodeImage(TiffOfStrips(options), "a.tif", {});
      // The library writes separate planes in strips of one row.
      EXPECT_EQ(image.has_value(), options.is_one_strip && !options.is_separate) << rows << " " << kind;
      if (image) {
        EXPECT_EQ(image->bytes, Pattern8(2, 200, 3)) << rows << " " << kind;
      } else {
        EXPECT_THAT(image.error().message, testing::HasSubstr("a.tif: damaged TIFF picture: "));
      }
    }
  }
}

TEST(DamagedImage, TiffTilesThatAreFarLargerThanThePictureAreRefused) {
  OIIO::ImageSpec spec(40, 40, 3, OIIO::TypeDesc::UINT8);
  spec.tile_width = spec.tile_height = 16;
  const std::string tiff = EncodeAs("tiff", spec);
  ASSERT_EQ(DecodeImage(tiff, "a.tif", {})->bytes, Pattern8(40, 40, 3));
  const std::string width_tag("\x42\x01", 2), height_tag("\x43\x01", 2), sample_format_tag("\x53\x01", 2);
  const std::string tile_depth_tag("\xe6\x80", 2);
  for (const std::string& tag : {width_tag, height_tag, sample_format_tag}) {
    for (const uint32_t side : {0x10000u, 0x7fffffffu, 0x7ffffff0u, 0x80000000u, 0xfffffff0u}) {
      std::string damaged = tiff;
      const size_t field = damaged.find(tag + '\x03');  // short integers
      ASSERT_NE(field, std::string::npos);
      damaged.replace(field, 8,
                      (tag == sample_format_tag ? tile_depth_tag : tag) + std::string("\4\0\1\0\0\0", 6));
      for (size_t i = 0; i < 4; ++i) damaged[field + 8 + i] = static_cast<char>(side >> (8 * i));
      const Result<Image> image = DecodeImage(damaged, "a.tif", {});
      ASSERT_FALSE(image) << side;
      EXPECT_THAT(image.error().message, testing::HasSubstr("a.tif: damaged TIFF picture: ")) << side;
    }
  }
}

TEST(DamagedImage, CompressedBmpFilesAreRefused) {
  for (const char compression : {1, 2}) {  // runs of 8 and of 4 bits, here without the palette that they need
    std::string bmp = Encode("bmp", 24, 10, 3, Pattern8(24, 10, 3));
    bmp[30] = compression;
    const Result<Image> image = DecodeImage(bmp, "a.bmp", {});
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().message, "a.bmp: compressed BMP pictures are not supported");
  }
}

TEST(DamagedImage, OpenExrChannelsOfUnknownTypesAreRefused) {
  std::string exr = Encode("openexr", 8, 8, 1, PatternFloat(8, 8, 1));
  const size_t list = exr.find("chlist");
  ASSERT_NE(list, std::string::npos);
  exr[list + 13] =
      7;  // after "chlist", a zero byte, the size of the list and the channel's name "Y" with a zero byte
  const Result<Image> image = DecodeImage(exr, "a.exr", {});
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message, testing::HasSubstr("a channel has an unknown type"));
}

TEST(DamagedImage, ChangedBytesEndWell) {
  std::mt19937 random(1);
  for (const Sample& sample : Samples()) {
    for (int i = 0; i < 200; ++i) {
      std::string bytes = sample.bytes;
      const size_t at = random() % (i % 2 == 0 ? std::min<size_t>(bytes.size(), 64) : bytes.size());
      bytes[at] = static_cast<char>(random());
      ExpectWholeOrRefused(bytes, sample.name, sample.name + " changed at " + std::to_string(at));
    }
  }
}

}  // namespace
}  // namespace tessera
