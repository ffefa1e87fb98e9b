// Variants of formats that programs write rarely and the library reads wrongly or not at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <webp/encode.h>
#include <zlib.h>

#include "renderer/image/declared_size.h"
#include "renderer/image/image.h"
#include "tests/renderer/exr_bytes.h"
#include "tests/renderer/image/encoded_images.h"

namespace tessera::image_variants {
namespace {

std::string LittleEndian16(uint32_t value) {
  return LittleEndian32(value).substr(0, 2);
}
std::string LittleEndian24(uint32_t value) {
  return LittleEndian32(value).substr(0, 3);
}

// ---- WebP

std::string Chunk(const std::string& kind, const std::string& data) {
  return kind + LittleEndian32(static_cast<uint32_t>(data.size())) + data +
         std::string(data.size() % 2, '\0');
}

std::string Riff(const std::string& chunks) {
  return Chunk("RIFF", "WEBP" + chunks);
}

// Without loss; `rgba` without pixels of alpha 0, whose colour the encoder changes.
std::string LosslessWebp(int width, int height, const std::vector<uint8_t>& rgba) {
  uint8_t* file = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, height, width * 4, &file);
  std::string bytes(reinterpret_cast<const char*>(file), size);
  WebPFree(file);
  return bytes;
}

// An animation whose first frame is the picture of `webp`, at a place of the canvas with even coordinates.
std::string Animation(uint32_t canvas_size, uint32_t frame_size, uint32_t frame_at, const std::string& webp) {
  constexpr size_t kRiffHeaderSize = 12;
  const std::string extended = std::string("\x12\0\0\0", 4) + LittleEndian24(canvas_size - 1) +
                               LittleEndian24(canvas_size - 1);  // with alpha and frames
  const std::string frame = LittleEndian24(frame_at / 2) + LittleEndian24(frame_at / 2) +
                            LittleEndian24(frame_size - 1) + LittleEndian24(frame_size - 1) +
                            LittleEndian24(100) + '\0' + webp.substr(kRiffHeaderSize);
  return Riff(Chunk("VP8X", extended) + Chunk("ANIM", std::string(6, '\xff')) + Chunk("ANMF", frame));
}

std::vector<uint8_t> PatternRgba(int width, int height) {
  std::vector<uint8_t> values = Pattern8(width, height, 4);
  for (size_t i = 3; i < values.size(); i += 4) values[i] = static_cast<uint8_t>(1 + i % 200);
  return values;
}

TEST(Webp, ColorsAreNotMultipliedByAlpha) {
  const std::vector<uint8_t> rgba = PatternRgba(9, 5);
  const Image image = Decoded(LosslessWebp(9, 5, rgba), "a.webp");
  EXPECT_EQ(image.channels, 4);
  EXPECT_EQ(image.bytes, rgba);
}

TEST(Webp, ColorsOfLossyPicturesAreNotMultipliedByAlphaEither) {
  std::vector<uint8_t> rgba;
  for (int i = 0; i < 16 * 16; ++i) rgba.insert(rgba.end(), {180, 180, 180, 64});
  uint8_t* file = nullptr;
  const size_t size = WebPEncodeRGBA(rgba.data(), 16, 16, 64, 90, &file);
  const Image image = Decoded(std::string(reinterpret_cast<const char*>(file), size), "a.webp");
  WebPFree(file);
  ASSERT_EQ(image.bytes.size(), rgba.size());
  for (size_t i = 0; i < rgba.size(); ++i) ASSERT_NEAR(image.bytes[i], rgba[i], 3) << i;
}

TEST(Webp, OfAnAnimationTheFirstFrameIsReadAndTheRestOfTheCanvasIsTransparent) {
  const std::vector<uint8_t> rgba = PatternRgba(4, 4);
  const Image whole = Decoded(Animation(4, 4, 0, LosslessWebp(4, 4, rgba)), "a.webp");
  EXPECT_EQ(whole.bytes, rgba);
  const Image placed = Decoded(Animation(8, 4, 2, LosslessWebp(4, 4, rgba)), "a.webp");
  ASSERT_EQ(placed.width, 8);
  ASSERT_EQ(placed.bytes.size(), 8u * 8 * 4);
  std::vector<uint8_t> expected(8 * 8 * 4);
  for (size_t y = 0; y < 4; ++y) std::copy_n(&rgba[y * 16], 16, &expected[((y + 2) * 8 + 2) * 4]);
  EXPECT_EQ(placed.bytes, expected);
}

TEST(Webp, AFrameBeyondTheCanvasIsRefused) {
  const std::string webp = LosslessWebp(4, 4, PatternRgba(4, 4));
  EXPECT_THAT(ErrorOf(Animation(4, 4, 2, webp), "a.webp"),
              testing::StartsWith("a.webp: damaged WebP picture"));
}

TEST(Webp, DamagedPixelsAreAnErrorInOneLine) {
  std::string webp = LosslessWebp(9, 5, PatternRgba(9, 5));
  for (size_t at = 30; at < webp.size(); ++at) webp[at] = '\xff';
  EXPECT_EQ(ErrorOf(webp, "a.webp"), "a.webp: damaged WebP picture: the pixels cannot be decoded");
}

// ---- BMP

struct Masks {
  uint32_t red, green, blue;
};

// Of 2x1 pixels, whose values are `pixels`.
std::string Bmp(uint32_t bits, const Masks& masks, const std::string& pixels) {
  constexpr uint32_t kBitFields = 3, kInfoSize = 40, kFirstPixelAt = 66;
  const auto file_size = static_cast<uint32_t>(kFirstPixelAt + pixels.size());
  return "BM" + LittleEndian32(file_size) + LittleEndian32(0) + LittleEndian32(kFirstPixelAt) +
         LittleEndian32(kInfoSize) + LittleEndian32(2) + LittleEndian32(1) + LittleEndian16(1) +
         LittleEndian16(bits) + LittleEndian32(kBitFields) + LittleEndian32(0) + LittleEndian32(0) +
         LittleEndian32(0) + LittleEndian32(0) + LittleEndian32(0) + LittleEndian32(masks.red) +
         LittleEndian32(masks.green) + LittleEndian32(masks.blue) + pixels;
}

TEST(BmpMasks, AnyOrderOfWholeBytesIsRead) {
  const std::vector<uint8_t> expected{1, 2, 3, 4, 5, 6};
  const Masks bgrx{0xff0000, 0xff00, 0xff}, rgbx{0xff, 0xff00, 0xff0000}, xbgr{0xff000000, 0xff0000, 0xff00},
      xrgb{0xff00, 0xff0000, 0xff000000}, brxg{0xff00, 0xff000000, 0xff};
  for (const auto& [masks, pixels] :
       {std::pair(bgrx, "\3\2\1\xff\6\5\4\xff"), std::pair(rgbx, "\1\2\3\xff\4\5\6\xff"),
        std::pair(xbgr, "\xff\3\2\1\xff\6\5\4"), std::pair(xrgb, "\xff\1\2\3\xff\4\5\6"),
        std::pair(brxg, "\3\1\xff\2\6\4\xff\5")}) {
    EXPECT_EQ(Decoded(Bmp(32, masks, pixels), "a.bmp").bytes, expected) << std::hex << masks.red;
  }
}

TEST(BmpMasks, OfSixteenBitsAreReadInAnyOrder) {
  const std::string red_green = LittleEndian16(0x1f) + LittleEndian16(0x7e0);
  const std::vector<uint8_t> expected{255, 0, 0, 0, 255, 0};
  EXPECT_EQ(Decoded(Bmp(16, {0x1f, 0x7e0, 0xf800}, red_green), "a.bmp").bytes, expected);
}

TEST(BmpMasks, ThatAreNotWholeBytesAreRefused) {
  const std::string pixels = "\3\2\1\xff\6\5\4\xff";
  for (const Masks& masks : {Masks{0x3ff00000, 0xffc00, 0x3ff}, Masks{0, 0xff00, 0xff},
                             Masks{0xff0000, 0xff000, 0xff}, Masks{0xff0000, 0xff00, 0xffff}}) {
    EXPECT_EQ(ErrorOf(Bmp(32, masks, pixels), "a.bmp"),
              "a.bmp: 32-bit BMP pictures whose masks are not whole bytes are not supported");
  }
  EXPECT_EQ(ErrorOf(Bmp(32, {0xff, 0xff00, 0xff0000}, pixels).substr(0, 60), "a.bmp"),
            "a.bmp: damaged BMP picture: unexpected end of file");
}

// ---- Radiance

std::string Hdr(int width, int height, const std::string& pixels) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
         std::to_string(width) + "\n" + pixels;
}

TEST(RadianceRuns, OfTheFirstEncodingAreRead) {
  const std::string one = "\x80\x40\x20\x81", two = "\x40\x80\x20\x80";
  const std::string row = one + two + two + two + two;
  const std::string run = one + two + "\1\1\1\3";
  const Image flat = Decoded(Hdr(5, 2, row + row), "a.hdr");
  EXPECT_FLOAT_EQ(flat.Get(0, 0, 0), 1);
  EXPECT_EQ(Decoded(Hdr(5, 2, run + row), "a.hdr").bytes, flat.bytes);
  EXPECT_EQ(Decoded(Hdr(5, 2, row + run), "a.hdr").bytes, flat.bytes);
  // Longer than a byte counts: 0x2c + 0x01 * 256 = 300 pixels.
  std::string long_row = one;
  for (int i = 0; i < 300; ++i) long_row += one;
  EXPECT_EQ(Decoded(Hdr(301, 1, one + "\1\1\1\x2c\1\1\1\1"), "a.hdr").bytes,
            Decoded(Hdr(301, 1, long_row), "a.hdr").bytes);
}

TEST(RadianceRuns, ThatLeaveTheirRowOrEndEarlyAreDamaged) {
  const std::string one = "\x80\x40\x20\x81", damaged = "a.hdr: damaged Radiance HDR picture: ";
  EXPECT_EQ(ErrorOf(Hdr(4, 1, one + "\1\1\1\4"), "a.hdr"), damaged + "a run of pixels leaves its row");
  EXPECT_EQ(ErrorOf(Hdr(4, 1, "\1\1\1\3" + one), "a.hdr"), damaged + "a run of pixels leaves its row");
  EXPECT_EQ(ErrorOf(Hdr(4, 2, one + "\1\1\1\3" + one), "a.hdr"), damaged + "unexpected end of file");
  std::string empty_runs = one;
  for (int i = 0; i < 5; ++i) empty_runs += std::string("\1\1\1\0", 4);
  EXPECT_EQ(ErrorOf(Hdr(4, 1, empty_runs + one), "a.hdr"), damaged + "a run of pixels leaves its row");
  EXPECT_THAT(ErrorOf(Hdr(40000, 40000, one + "\1\1\1\3"), "a.hdr"), testing::HasSubstr("a.hdr: "));
}

// ---- BigTIFF

// Of 2x1 pixels of three bytes, in 64-bit fields.
std::string BigTiff(bool is_little, uint32_t width_type) {
  const auto number = [&](uint64_t value, int size) {
    std::string bytes;
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * (is_little ? i : size - 1 - i));
    return bytes;
  };
  const auto entry = [&](uint64_t tag, uint64_t type, uint64_t count, uint64_t value) {
    constexpr int kSizes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8};
    std::string field = count == 1 ? number(value, kSizes[type]) : "";
    for (uint64_t i = 0; count > 1 && i < count; ++i) field += number(value, kSizes[type]);
    return number(tag, 2) + number(type, 2) + number(count, 8) + field + std::string(8 - field.size(), '\0');
  };
  constexpr uint64_t kShort = 3, kLong = 4, kFirstPixelAt = 16, kDirectoryAt = 24;
  const std::string directory = number(10, 8) + entry(256, width_type, 1, 2) + entry(257, kShort, 1, 1) +
                                entry(258, kShort, 3, 8) + entry(259, kShort, 1, 1) +
                                entry(262, kShort, 1, 2) + entry(273, kLong, 1, kFirstPixelAt) +
                                entry(277, kShort, 1, 3) + entry(278, kShort, 1, 1) +
                                entry(279, kLong, 1, 6) + entry(284, kShort, 1, 1) + number(0, 8);
  return std::string(is_little ? "II" : "MM") + number(43, 2) + number(8, 2) + number(0, 2) +
         number(kDirectoryAt, 8) + "\1\2\3\4\5\6" + std::string(2, '\0') + directory;
}

TEST(BigTiff, OfBothByteOrdersIsRead) {
  constexpr uint32_t kShort = 3, kLong = 4;
  for (const bool is_little : {true, false}) {
    for (const uint32_t type : {kShort, kLong}) {
      const Image image = Decoded(BigTiff(is_little, type), "a.tif");
      EXPECT_EQ(image.bytes, (std::vector<uint8_t>{1, 2, 3, 4, 5, 6})) << is_little << type;
    }
  }
}

TEST(BigTiff, DeclaresItsSize) {
  for (const bool is_little : {true, false}) {
    for (const uint32_t type : {3u, 4u, 16u}) {
      const auto size = FindDeclaredSize(ImageFormat::kTiff, BigTiff(is_little, type));
      ASSERT_TRUE(size);
      EXPECT_EQ(size->width, 2);
      EXPECT_EQ(size->height, 1);
    }
    std::string large = BigTiff(is_little, 16);
    large[is_little ? 24 + 8 + 12 + 4 : 24 + 8 + 12 + 3] = '\1';  // 2^32 more columns
    EXPECT_THAT(ErrorOf(large, "a.tif"), testing::HasSubstr("picture too large: 4294967298x1"));
    const std::string whole = BigTiff(is_little, 4);
    for (size_t length = 0; length < whole.size(); ++length)
      FindDeclaredSize(ImageFormat::kTiff, whole.substr(0, length));
  }
}

// ---- TIFF strips

// Of 2 x 3 pixels of three bytes, 1, 2, 3 and so on, in one strip for each plane.
std::string TiffOfPlanes(bool is_zipped, std::optional<uint32_t> rows_per_strip) {
  const auto number = [](uint32_t value, int size) {
    std::string bytes;
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * i);
    return bytes;
  };
  std::string strips, offsets, lengths;
  for (int plane = 0; plane < 3; ++plane) {
    std::string values;
    for (int pixel = 0; pixel < 6; ++pixel) values += static_cast<char>(1 + 3 * pixel + plane);
    if (is_zipped) {
      std::string packed(compressBound(values.size()), '\0');
      uLongf size = packed.size();
      compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(values.data()),
               values.size());
      values = packed.substr(0, size);
    }
    offsets += number(static_cast<uint32_t>(8 + strips.size()), 4);
    lengths += number(static_cast<uint32_t>(values.size()), 4);
    strips += values;
  }
  constexpr uint32_t kShort = 3, kLong = 4;
  const auto offsets_at = static_cast<uint32_t>(8 + strips.size());
  const uint32_t lengths_at = offsets_at + 12, bits_at = offsets_at + 24, directory_at = offsets_at + 30;
  const auto entry = [&](uint32_t tag, uint32_t type, uint32_t count, uint32_t value) {
    return number(tag, 2) + number(type, 2) + number(count, 4) + number(value, 4);
  };
  std::string entries = entry(256, kShort, 1, 2) + entry(257, kShort, 1, 3) + entry(258, kShort, 3, bits_at) +
                        entry(259, kShort, 1, is_zipped ? 8 : 1) + entry(262, kShort, 1, 2) +
                        entry(273, kLong, 3, offsets_at) + entry(277, kShort, 1, 3);
  if (rows_per_strip) entries += entry(278, kLong, 1, *rows_per_strip);
  entries += entry(279, kLong, 3, lengths_at) + entry(284, kShort, 1, 2);
  return "II" + number(42, 2) + number(directory_at, 4) + strips + offsets + lengths + number(8, 2) +
         number(8, 2) + number(8, 2) + number(static_cast<uint32_t>(entries.size() / 12), 2) + entries +
         number(0, 4);
}

// Compressed planes of this kind are beyond the library.
TEST(TiffStrips, OfAllRowsAreReadOrRefusedWhateverNumberTheirFileStates) {
  constexpr uint32_t kHeight = 3;
  std::vector<uint8_t> pixels(18);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(i + 1);
  for (const std::optional<uint32_t> rows :
       std::vector<std::optional<uint32_t>>{kHeight, 4, 0x40000001, 0x7fffffff, 0x80000000, 0xffffffff, {}}) {
    SCOPED_TRACE(rows.value_or(0));
    EXPECT_EQ(Decoded(TiffOfPlanes(false, rows), "a.tif").bytes, pixels);
    const std::string zipped = TiffOfPlanes(true, rows);
    if (rows == kHeight) {
      EXPECT_EQ(Decoded(zipped, "a.tif").bytes, pixels);
    } else {
      EXPECT_THAT(ErrorOf(zipped, "a.tif"), testing::HasSubstr("does not support random access"));
    }
  }
}

// ---- OpenEXR

TEST(OpenExrChannels, OfFewerValuesThanPixelsAreNotSupportedButNotDamaged) {
  std::string file = ExrHeader(2, 2, "BGR", "");
  const size_t sampling = file.find(std::string("G\0", 2)) + 2 + 8;
  file[sampling] = 2;
  EXPECT_EQ(ErrorOf(file, "a.exr"), "a.exr: channel G is subsampled, which is not supported");
}

}  // namespace
}  // namespace tessera::image_variants
