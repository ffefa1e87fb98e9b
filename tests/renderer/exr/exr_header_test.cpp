#include "renderer/exr/exr_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/renderer/exr_bytes.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Result<void> AllowAll(int64_t, int64_t, int64_t) {
  return {};
}

std::string ErrorOf(std::string_view bytes, const ExrSizeCheck& check_size = AllowAll) {
  const Result<void> checked = CheckExr(bytes, "a.exr", check_size);
  return checked ? "no error" : checked.error().message;
}

std::string WithCompression(std::string header, char number) {
  const std::string before = ExrAttribute("compression", "compression", "?");
  header[header.find(before.substr(0, before.size() - 1)) + before.size() - 1] = number;
  return header;
}

std::string Tiled(uint32_t width, uint32_t height) {
  std::string header = ExrHeader(
      8, 8, "BGR", ExrAttribute("tiles", "tiledesc", LittleEndian32(width) + LittleEndian32(height) + '\0'));
  header[5] |= 2;  // the flag of tiles
  return header;
}

TEST(ExrHeader, WholeFilesPass) {
  EXPECT_EQ(ErrorOf(ExrOf(2, 2, std::vector<float>(12, 1))), "no error");
}

TEST(ExrHeader, OtherFilesAreNotCalledDamaged) {
  for (const char* bytes : {"", "P", "\x89PNG\r\n\x1a\n"})
    EXPECT_EQ(ErrorOf(bytes), "a.exr: is not an OpenEXR file");
}

TEST(ExrHeader, NoPrefixOfAHeaderPasses) {
  const std::string header = ExrHeader(2, 2, "BGR", "");
  for (size_t size = 4; size < header.size(); ++size)
    EXPECT_THAT(ErrorOf(header.substr(0, size)), HasSubstr("damaged OpenEXR picture")) << size;
}

TEST(ExrHeader, TheCallerDecidesAboutTheSizeOfPictureAndTiles) {
  std::vector<std::vector<int64_t>> sizes;
  const auto note = [&](int64_t width, int64_t height, int64_t channels) -> Result<void> {
    sizes.push_back({width, height, channels});
    return {};
  };
  EXPECT_EQ(ErrorOf(Tiled(64, 32) + std::string(100, '\0'), note), "no error");
  EXPECT_THAT(sizes, ElementsAre(ElementsAre(8, 8, 3), ElementsAre(64, 32, 3)));
  const auto refuse = [](int64_t width, int64_t, int64_t) -> Result<void> {
    return width == 64 ? Result<void>(BadInput("too wide")) : Result<void>();
  };
  EXPECT_EQ(ErrorOf(Tiled(64, 32), refuse), "too wide");
}

TEST(ExrHeader, BlocksOfScanLinesAreBounded) {
  constexpr char kZip = 3, kDwab = 9;
  const std::string wide = ExrHeader(65536, 1, std::string(17, 'a'), "") + std::string(100, '\0');
  EXPECT_EQ(ErrorOf(WithCompression(wide, kZip)), "no error");
  EXPECT_THAT(ErrorOf(WithCompression(wide, kDwab)), HasSubstr("in blocks that are too large"));
  EXPECT_THAT(ErrorOf(WithCompression(wide, 10)), HasSubstr("the compression is unknown"));
}

TEST(ExrHeader, TablesOfOffsetsFitInTheFile) {
  EXPECT_THAT(ErrorOf(ExrHeader(1, 60000, "R", "")), HasSubstr("bytes cannot hold 60000 blocks of pixels"));
  EXPECT_EQ(ErrorOf(ExrHeader(1, 60000, "R", "") + std::string(60000 * 8, '\0')), "no error");
  const std::string many = ExrAttribute("chunkCount", "int", LittleEndian32(0x7fffffff));
  EXPECT_THAT(ErrorOf(ExrHeader(2, 2, "R", many)), HasSubstr("bytes cannot hold 2147483647 blocks"));
}

TEST(ExrHeader, TablesOfAllPartsTogetherFitInTheFile) {
  const std::string header = ExrHeader(1, 100, "R", "");
  std::string file = header.substr(0, 8);
  file[5] |= 0x10;  // the flag of several parts
  for (int part = 0; part < 4; ++part) file += header.substr(8);
  file += '\0';
  ASSERT_LT(file.size(), 400u * 8);
  EXPECT_THAT(ErrorOf(file), HasSubstr("bytes cannot hold"));
  EXPECT_EQ(ErrorOf(file + std::string(400 * 8, '\0')), "no error");
}

}  // namespace
}  // namespace tessera
