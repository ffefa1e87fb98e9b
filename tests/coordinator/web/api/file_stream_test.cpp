// Downloads whose temporary file cannot be read.
#include "coordinator/web/api/file_stream.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(FileStream, SendsWhatItWasGiven) {
  const std::string bytes(700'000, 'x');
  auto file = ReadableFile::Nameless("/tmp", bytes);
  ASSERT_TRUE(file) << file.error().message;
  FileStream stream(std::move(*file));
  std::vector<BodyStream::Part> parts;
  while (stream.Take(parts) == BodyStream::Next::kParts) {
  }
  std::string sent;
  for (const auto& part : parts) sent += *part;
  EXPECT_EQ(sent, bytes);
}

TEST(FileStream, AFileThatCannotBeReadEndsTheDownloadWithALine) {
  FileStream stream(ReadableFile(FileDescriptor(::open("/dev/null", O_WRONLY | O_CLOEXEC)), 100));
  std::vector<BodyStream::Part> parts;
  testing::internal::CaptureStdout();
  EXPECT_EQ(stream.Take(parts), BodyStream::Next::kEnd);
  EXPECT_THAT(
      testing::internal::GetCapturedStdout(),
      testing::ContainsRegex("web_download_cut count=1 sent=0 bytes=100 reason=\"Bad file descriptor\""));
  EXPECT_TRUE(parts.empty());
}

}  // namespace
}  // namespace tessera
