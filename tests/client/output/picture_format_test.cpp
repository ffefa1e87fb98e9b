#include "client/output/picture_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(PictureFormatOf, IsTheOneThatTheEndingNames) {
  const std::pair<const char*, PictureFormat> cases[] = {
      {"a.exr", PictureFormat::kExr},      {"a.b.PNG", PictureFormat::kPng},
      {"a.jpg", PictureFormat::kJpeg},     {"x/a.JPEG", PictureFormat::kJpeg},
      {"a.tif", PictureFormat::kTiff},     {"a.tiff", PictureFormat::kTiff},
      {"a.hdr", PictureFormat::kRadiance}, {"a.pfm", PictureFormat::kPfm},
      {"/dev/null", PictureFormat::kExr},  {"shot.1/picture", PictureFormat::kExr},
      {".png", PictureFormat::kPng},
  };
  for (const auto& [name, format] : cases) {
    const auto found = PictureFormatOf(name);
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(*found, format) << name;
  }
}

TEST(PictureFormatOf, RefusesOtherEndingsByName) {
  for (const char* name : {"a.pbrt", "a.ex", "a.gif", "a.exr.tmp", "a."}) {
    const auto format = PictureFormatOf(name);
    ASSERT_FALSE(format) << name;
    EXPECT_EQ(format.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(format.error().message, HasSubstr(std::string(name) + ": cannot write pictures of type"));
  }
}

TEST(PictureFormatOf, LimitsTheSizeOfJpegs) {
  EXPECT_TRUE(CheckFormatSize("a.jpg", 65500, 10));
  EXPECT_FALSE(CheckFormatSize("a.jpg", 10, 65501));
  EXPECT_TRUE(CheckFormatSize("a.png", 10, 65536));
}

}  // namespace
}  // namespace tessera
