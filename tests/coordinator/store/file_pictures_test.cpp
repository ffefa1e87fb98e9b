#include "coordinator/store/file_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
