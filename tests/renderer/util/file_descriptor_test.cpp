#include "renderer/util/file_descriptor.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "renderer/util/file.h"

namespace tessera {
namespace {

bool IsOpen(int descriptor) {
  return ::fcntl(descriptor, F_GETFD) >= 0;
}

TEST(FileDescriptor, IsClosedOnceByItsLastOwner) {
  FileDescriptor first(::open("/dev/null", O_WRONLY | O_CLOEXEC));
  ASSERT_TRUE(first);
  const int number = first.number();
  {
    const FileDescriptor second(std::move(first));
    EXPECT_FALSE(first);  // NOLINT(bugprone-use-after-move): it owns nothing
    EXPECT_EQ(second.number(), number);
    EXPECT_TRUE(IsOpen(number));
  }
  EXPECT_FALSE(IsOpen(number));
  EXPECT_TRUE(first.Close()) << "there is nothing to close";
}

TEST(FileDescriptor, WhatCannotBeWrittenIsAFailureWithItsReason) {
  const FileDescriptor full(::open("/dev/full", O_WRONLY | O_CLOEXEC));
  ASSERT_TRUE(full);
  EXPECT_FALSE(WriteAll(full.number(), "bytes"));
  EXPECT_EQ(errno, ENOSPC);
  EXPECT_TRUE(WriteAll(full.number(), ""));
}

TEST(NamelessFile, KeepsBytesAndIsNotInItsFolder) {
  const std::string folder = testing::TempDir() + "nameless_file_test";
  ASSERT_TRUE(CreateFolders(folder));
  const auto file = OpenNamelessFile(folder);
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_TRUE(WriteAll(file->number(), "some bytes"));
  char bytes[16];
  EXPECT_EQ(::pread(file->number(), bytes, sizeof bytes, 5), 5);
  EXPECT_EQ(std::string(bytes, 5), "bytes");
  const auto names = ListFolder(folder);
  ASSERT_TRUE(names);
  EXPECT_THAT(*names, testing::IsEmpty());
  ::rmdir(folder.c_str());
  EXPECT_THAT(OpenNamelessFile(folder).error().message,
              testing::HasSubstr("cannot be created: No such file"));
}

}  // namespace
}  // namespace tessera
