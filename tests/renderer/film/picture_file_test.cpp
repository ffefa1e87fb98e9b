#include "renderer/film/picture_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "renderer/util/file.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// A folder of its own for each test, removed after it.
class PictureFile : public testing::Test {
 protected:
  PictureFile() {
    std::string name = testing::TempDir() + "tessera-film-XXXXXX";
    folder_ = ::mkdtemp(name.data());
  }
  ~PictureFile() override { std::filesystem::remove_all(folder_); }
  std::string Save(const std::string& bytes) {
    const std::string path = folder_ + "/picture.exr";
    EXPECT_TRUE(WriteFileAtomically(path, bytes));
    return path;
  }
  Result<LoadedPicture> SaveAndLoad(const std::string& bytes) { return LoadExr(Save(bytes)); }

 private:
  std::string folder_;
};

FrameSpec Spec(ExrType type) {
  FrameSpec spec;
  spec.width = 40;
  spec.height = 30;
  spec.crop = {5, 7, 25, 27};
  spec.samples_per_pixel = 4;
  spec.exr_type = type;
  spec.attributes = {{"tessera.seed", "17"}, {"tessera.version", "0.1"}};
  return spec;
}

FramePicture Picture(const FrameSpec& spec) {
  FramePicture picture;
  picture.bounds = spec.crop;
  picture.channels = {"R", "G", "B"};
  const size_t count = static_cast<size_t>(spec.crop.area()) * 3;
  for (size_t i = 0; i < count; ++i) picture.values.push_back(static_cast<float>(i) * 0.0371f);
  return picture;
}

float ValueOf(const LoadedPicture& picture, const std::string& channel, size_t pixel) {
  const auto found = std::ranges::find(picture.channels, channel);
  const size_t c = static_cast<size_t>(found - picture.channels.begin());
  return picture.values[pixel * picture.channels.size() + c];
}

TEST_F(PictureFile, FloatsComeBackToTheBitWithWindowsAndAttributes) {
  const FrameSpec spec = Spec(ExrType::kFloat);
  const FramePicture picture = Picture(spec);
  const auto loaded = SaveAndLoad(EncodeExr(spec, picture).value());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->width, 40);
  EXPECT_EQ(loaded->height, 30);
  EXPECT_EQ(loaded->bounds, spec.crop);
  EXPECT_THAT(loaded->channels, testing::UnorderedElementsAre("R", "G", "B"));
  EXPECT_EQ(loaded->attributes, spec.attributes);
  for (size_t pixel = 0; pixel < picture.values.size() / 3; ++pixel) {
    EXPECT_EQ(ValueOf(*loaded, "R", pixel), picture.values[pixel * 3]);
    EXPECT_EQ(ValueOf(*loaded, "G", pixel), picture.values[pixel * 3 + 1]);
    EXPECT_EQ(ValueOf(*loaded, "B", pixel), picture.values[pixel * 3 + 2]);
  }
}

TEST_F(PictureFile, HalvesAreRoundedAndClampedToTheLargestOne) {
  const FrameSpec spec = Spec(ExrType::kHalf);
  FramePicture picture = Picture(spec);
  picture.values[0] = 1e9f;
  picture.values[1] = -1e9f;
  picture.values[2] = std::numeric_limits<float>::infinity();
  const auto loaded = SaveAndLoad(EncodeExr(spec, picture).value());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(ValueOf(*loaded, "R", 0), 65504.0f);
  EXPECT_EQ(ValueOf(*loaded, "G", 0), -65504.0f);
  EXPECT_EQ(ValueOf(*loaded, "B", 0), 65504.0f);
  for (size_t pixel = 1; pixel < picture.values.size() / 3; ++pixel) {
    const float value = picture.values[pixel * 3];
    EXPECT_NEAR(ValueOf(*loaded, "R", pixel), value, value * 0x1p-11f + 1e-7f);
  }
}

TEST_F(PictureFile, CountsOfSamplesStayExactBesideHalves) {
  FrameSpec spec = Spec(ExrType::kHalf);
  AddChannel(spec.channels, SamplesChannel(true));
  FramePicture picture{spec.crop, {"R", "G", "B", "samples"}, {}};
  picture.values.assign(static_cast<size_t>(spec.crop.area()) * 4, 65537.0f);
  picture.values[7 * 4 + 3] = 3;
  const auto loaded = SaveAndLoad(EncodeExr(spec, picture).value());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->channels, testing::UnorderedElementsAre("R", "G", "B", "samples"));
  EXPECT_EQ(ValueOf(*loaded, "samples", 0), 65537.0f);
  EXPECT_EQ(ValueOf(*loaded, "samples", 7), 3.0f);
  EXPECT_EQ(ValueOf(*loaded, "R", 0), 65504.0f);
}

TEST_F(PictureFile, APictureOfOtherChannelsThanTheFrameWritesIsRefused) {
  const FrameSpec spec = Spec(ExrType::kHalf);
  FramePicture picture = Picture(spec);
  picture.values.pop_back();
  EXPECT_FALSE(EncodeExr(spec, picture));
  picture = Picture(spec);
  picture.channels = {"R", "G", "Z"};
  EXPECT_FALSE(EncodeExr(spec, picture));
}

TEST_F(PictureFile, EqualPicturesGiveEqualBytes) {
  for (ExrType type : {ExrType::kHalf, ExrType::kFloat}) {
    const FrameSpec spec = Spec(type);
    EXPECT_EQ(*EncodeExr(spec, Picture(spec)), *EncodeExr(spec, Picture(spec)));
  }
}

TEST_F(PictureFile, BytesInMemoryAreDecodedAsTheSameBytesInAFile) {
  const FrameSpec spec = Spec(ExrType::kHalf);
  const std::string bytes = *EncodeExr(spec, Picture(spec));
  const auto from_memory = DecodeExr(bytes, "memory"), from_file = SaveAndLoad(bytes);
  ASSERT_TRUE(from_memory) << from_memory.error().message;
  EXPECT_EQ(from_memory->bounds, from_file->bounds);
  EXPECT_EQ(from_memory->channels, from_file->channels);
  EXPECT_EQ(from_memory->values, from_file->values);
  for (size_t size = 0; size < bytes.size(); size += 97) {
    const auto torn = DecodeExr(bytes.substr(0, size), "torn.exr");
    ASSERT_FALSE(torn) << size;
    EXPECT_THAT(torn.error().message, HasSubstr("torn.exr"));
  }
}

TEST_F(PictureFile, AnEmptyFileAndAFolderAreRefusedByName) {
  const auto empty = SaveAndLoad("");
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(empty.error().message, HasSubstr("picture.exr"));
  EXPECT_FALSE(LoadExr("/nowhere/at/all.exr"));
  EXPECT_FALSE(LoadExr("/tmp"));
}

TEST_F(PictureFile, DamagedFilesAreRefusedOrReadButNeverCrash) {
  const FrameSpec spec = Spec(ExrType::kHalf);
  const std::string bytes = *EncodeExr(spec, Picture(spec));
  for (size_t i = 0; i < 600; ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0xff);
    const auto loaded = SaveAndLoad(damaged);
    if (!loaded) {
      EXPECT_THAT(loaded.error().message, testing::Not(HasSubstr("\n")));
    }
  }
  for (size_t size = 0; size < bytes.size(); size += 97)
    EXPECT_FALSE(SaveAndLoad(bytes.substr(0, size))) << size;
}

}  // namespace
}  // namespace tessera
