#include "coordinator/store/file_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/coordinator/no_new_files.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

PictureFile FileOf(std::string_view bytes) {
  return {Sha256(bytes), bytes.size()};
}

TEST(FilePictures, APictureIsReadAsItWasLastWritten) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, "old"));
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, "new"));
  ASSERT_TRUE(pictures.Write(JobId{3}, 1, "other"));
  EXPECT_EQ(*pictures.Read(JobId{3}, 0, FileOf("new")), "new");
  const FilePictures next(directory.path());
  EXPECT_EQ(*next.Read(JobId{3}, 1, FileOf("other")), "other") << "by the next process, too";
  EXPECT_TRUE(next.Probe(JobId{3}, 1, FileOf("other")));
  EXPECT_EQ(*next.Read(JobId{3}, 1, {Sha256("other"), 0}), "other") << "its size may be unknown";
}

TEST(FilePictures, APictureThatIsNotThereIsAFailureThatNamesItsFile) {
  const TemporaryDir directory;
  const auto read = FilePictures(directory.path()).Read(JobId{3}, 7, FileOf("x"));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(read.error().message, testing::HasSubstr("3/7.exr"));
}

TEST(FilePictures, APictureWithOtherBytesThanThoseWrittenIsRefusedByName) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  const PictureFile file = FileOf("picture");
  for (const std::string_view damaged : {"pictuRe", "pict", "pictures", ""}) {
    ASSERT_TRUE(pictures.Write(JobId{3}, 0, damaged));
    const auto read = pictures.Read(JobId{3}, 0, file);
    ASSERT_FALSE(read) << damaged;
    EXPECT_THAT(read.error().message, testing::HasSubstr("3/0.exr: is corrupt")) << damaged;
    EXPECT_EQ(pictures.Probe(JobId{3}, 0, file).has_value(), damaged.size() == 7) << damaged;
  }
}

TEST(FilePictures, APictureIsOpenedWithTheBytesAndTheDigestThatItWasWrittenWith) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  const std::string bytes = std::string(3'000'000, 'a') + "the last of four pieces";
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, bytes));
  for (const std::optional<PictureFile>& file :
       {std::optional(FileOf(bytes)), std::optional<PictureFile>()}) {
    const auto picture = pictures.Open(JobId{3}, 0, file);
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_EQ(picture->digest, Sha256(bytes));
    pictures.Remove(JobId{3});
    std::string read(picture->file.size(), '?');
    ASSERT_TRUE(picture->file.Read(0, read));
    EXPECT_TRUE(read == bytes) << "it is open";
    ASSERT_TRUE(pictures.Write(JobId{3}, 0, bytes));
  }
}

TEST(FilePictures, APictureThatIsDamagedOrNotThereIsNotOpened) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  const PictureFile file = FileOf("picture");
  for (const std::string_view damaged : {"pictuRe", "pict", "pictures", ""}) {
    ASSERT_TRUE(pictures.Write(JobId{3}, 0, damaged));
    const auto opened = pictures.Open(JobId{3}, 0, file);
    ASSERT_FALSE(opened) << damaged;
    EXPECT_THAT(opened.error().message, testing::HasSubstr("3/0.exr: is corrupt")) << damaged;
  }
  for (const std::optional<PictureFile>& each : {std::optional(file), std::optional<PictureFile>()}) {
    const auto missing = pictures.Open(JobId{3}, 7, each);
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kFailed);
    EXPECT_THAT(missing.error().message, testing::HasSubstr("3/7.exr: cannot be opened"));
  }
}

TEST(FilePictures, APictureThatCannotBeOpenedForLackOfDescriptorsIsNotDamaged) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, "picture"));
  {
    const NoNewFiles none;
    const auto opened = pictures.Open(JobId{3}, 0, FileOf("picture"));
    const auto read = pictures.Read(JobId{3}, 0, FileOf("picture"));
    ASSERT_FALSE(opened || read);
    for (const Error& error : {opened.error(), read.error()}) {
      EXPECT_EQ(error.kind, ErrorKind::kInterrupted);
      EXPECT_THAT(error.message, testing::HasSubstr("3/0.exr: cannot be opened: Too many open files"));
    }
  }
  EXPECT_TRUE(pictures.Open(JobId{3}, 0, FileOf("picture")));
}

TEST(FilePictures, RemovesThePicturesOfOneJobOnly) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, "a"));
  ASSERT_TRUE(pictures.Write(JobId{4}, 0, "b"));
  pictures.Remove(JobId{3});
  pictures.Remove(JobId{3});
  EXPECT_FALSE(pictures.Read(JobId{3}, 0, FileOf("a")));
  EXPECT_EQ(*pictures.Read(JobId{4}, 0, FileOf("b")), "b");
}

}  // namespace
}  // namespace tessera
