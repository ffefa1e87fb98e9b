#include "coordinator/store/file_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

TEST(FilePictures, APictureIsReadAsItWasLastWritten) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, "old"));
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, "new"));
  ASSERT_TRUE(pictures.Write(JobId{3}, 1, "other"));
  EXPECT_EQ(*pictures.Read(JobId{3}, 0), "new");
  EXPECT_EQ(*FilePictures(directory.path()).Read(JobId{3}, 1), "other") << "by the next process, too";
}

TEST(FilePictures, APictureThatIsNotThereIsAFailureThatNamesItsFile) {
  const TemporaryDir directory;
  const auto read = FilePictures(directory.path()).Read(JobId{3}, 7);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(read.error().message, testing::HasSubstr("3/7.exr"));
}

TEST(FilePictures, RemovesThePicturesOfOneJobOnly) {
  const TemporaryDir directory;
  FilePictures pictures(directory.path());
  ASSERT_TRUE(pictures.Write(JobId{3}, 0, "a"));
  ASSERT_TRUE(pictures.Write(JobId{4}, 0, "b"));
  pictures.Remove(JobId{3});
  pictures.Remove(JobId{3});
  EXPECT_FALSE(pictures.Read(JobId{3}, 0));
  EXPECT_EQ(*pictures.Read(JobId{4}, 0), "b");
}

}  // namespace
}  // namespace tessera
