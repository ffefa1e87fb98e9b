// Small files that announce much: refused before OpenEXR allocates what they announce.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "renderer/film/picture_file.h"
#include "tests/renderer/exr_bytes.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

std::string LoadErrorOf(const std::string& bytes) {
  const auto picture = DecodeExr(bytes, "a.exr");
  if (picture) return "no error";
  EXPECT_EQ(picture.error().kind, ErrorKind::kBadInput);
  return picture.error().message;
}

long PeakMegabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss >> 10;
}

// An attribute that claims to have `size` bytes.
std::string Claim(const char* type, uint32_t size) {
  return std::string("claim") + '\0' + type + '\0' + LittleEndian32(size) + "abc";
}

TEST(HostilePicture, AttributesBeyondTheFileAreRefusedBeforeTheyTakeMemory) {
  const long before = PeakMegabytes();
  for (const char* type : {"string", "preview", "unknown"}) {
    for (const uint32_t size : {1000u, 0x70000000u, 0xffffffffu}) {
      const std::string file = ExrHeader(2, 2, "BGR", Claim(type, size)) + std::string(64, '\0');
      EXPECT_THAT(LoadErrorOf(file),
                  AllOf(StartsWith("a.exr: damaged OpenEXR picture: the attribute \"claim\""),
                        EndsWith("bytes, more than the file")));
    }
  }
  EXPECT_LT(PeakMegabytes() - before, 200);
}

TEST(HostilePicture, WindowsThatTheFileCannotFillAreRefusedBeforeTheyTakeMemory) {
  const long before = PeakMegabytes();
  const std::string table(16384 * 8, '\0');
  EXPECT_THAT(LoadErrorOf(ExrHeader(16384, 16384, "ABGR", "") + table),
              HasSubstr("bytes cannot hold 4 channels of 16384x16384 pixels"));
  EXPECT_THAT(LoadErrorOf(ExrHeader(65536, 65536, "ABGR", "") + table), HasSubstr("more than the limit of"));
  EXPECT_THAT(LoadErrorOf(ExrHeader(65537, 1, "R", "") + table), HasSubstr("beyond the limits"));
  EXPECT_THAT(LoadErrorOf(ExrHeader(0, 1, "R", "") + table), HasSubstr("beyond the limits"));
  EXPECT_THAT(LoadErrorOf(ExrHeader(0x7fffffff, 0x7fffffff, "R", "") + table),
              HasSubstr("beyond the limits"));
  EXPECT_THAT(LoadErrorOf(ExrHeader(1, 1, "", "") + table), HasSubstr("0 channels"));
  EXPECT_THAT(LoadErrorOf(ExrHeader(1, 1, std::string(257, 'c'), "") + table), HasSubstr("257 channels"));
  EXPECT_LT(PeakMegabytes() - before, 200);
}

TEST(HostilePicture, TilesAndChannelTypesAreChecked) {
  std::string tiled = ExrHeader(
      8, 8, "R", ExrAttribute("tiles", "tiledesc", LittleEndian32(65536) + LittleEndian32(65536) + '\0'));
  tiled[5] |= 2;  // the flag of tiles
  EXPECT_THAT(LoadErrorOf(tiled), HasSubstr("more than the limit of"));
  std::string unknown = ExrHeader(8, 8, "R", "") + std::string(64, '\0');
  unknown[unknown.find(std::string("R\0", 2)) + 2] = 77;
  EXPECT_THAT(LoadErrorOf(unknown), EndsWith("a channel has an unknown type"));
}

TEST(HostilePicture, OtherFilesAreRefusedByName) {
  EXPECT_EQ(LoadErrorOf("\x89PNG\r\n\x1a\n"), "a.exr: is not an OpenEXR file");
}

// Compresses by nearly 1000.
TEST(HostilePicture, BlackPicturesOfOursAreNotTakenForHostile) {
  for (const ExrType type : {ExrType::kHalf, ExrType::kFloat}) {
    FrameSpec spec;
    spec.width = spec.height = 4096;
    spec.crop = {0, 0, 4096, 2048};
    spec.samples_per_pixel = 1;
    spec.exr_type = type;
    FramePicture picture;
    picture.bounds = spec.crop;
    picture.channels = {"R", "G", "B"};
    picture.values.assign(static_cast<size_t>(spec.crop.area()) * 3, 0.0f);
    const auto bytes = EncodeExr(spec, picture);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const auto loaded = DecodeExr(*bytes, "black.exr");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->bounds, spec.crop);
  }
}

}  // namespace
}  // namespace tessera
