// Whatever the bytes, decoding ends with a picture that is whole or with one line that names the file.
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

// A TIFF file of 2 x 200 pixels whose first row has this number.
std::string TiffAtRow(int row) {
  OIIO::ImageSpec spec(2, 200, 3, OIIO::TypeDesc::UINT8);
  spec.y = row;
  std::vector<unsigned char> file;
  OIIO::Filesystem::IOVecOutput proxy(file);
  const auto output = OIIO::ImageOutput::create("tiff");
  output->set_ioproxy(&proxy);
  EXPECT_TRUE(output->open("a.tif", spec) &&
              output->write_image(OIIO::TypeDesc::UINT8, Pattern8(2, 200, 3).data()) && output->close());
  return {file.begin(), file.end()};
}

TEST(DamagedImage, ATiffFileWhoseRowsHaveNumbersBeyondTheLargestIsRefused) {
  for (const int row : {5, 1 << 30}) {
    const Result<Image> image = DecodeImage(TiffAtRow(row), "a.tif", {});
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->bytes, Pattern8(2, 200, 3)) << row;
  }
  constexpr int kLargestFloat = 2'147'483'520;  // that is an int
  const Result<Image> image = DecodeImage(TiffAtRow(kLargestFloat), "a.tif", {});
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().message, "a.tif: damaged TIFF picture: its position is out of range");
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
