#include "proto/wire/channel.h"

#include <gmock/gmock.h>
#include <grpcpp/support/status.h>
#include <gtest/gtest.h>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(ErrorOfACall, AlwaysHasAReason) {
  for (const auto code : {grpc::StatusCode::INTERNAL, grpc::StatusCode::UNKNOWN,
                          grpc::StatusCode::INVALID_ARGUMENT, grpc::StatusCode::RESOURCE_EXHAUSTED}) {
    const Error error = ToError({code, ""}, "submit the job");
    EXPECT_EQ(error.message,
              "cannot submit the job: the message or its answer could not be read (gRPC status " +
                  std::to_string(code) + ")");
  }
  EXPECT_THAT(ToError({grpc::StatusCode::INTERNAL, "RST_STREAM"}, "x").message,
              HasSubstr("RST_STREAM (gRPC status 13)"));
  EXPECT_EQ(ToError({grpc::StatusCode::FAILED_PRECONDITION, "no"}, "x").message, "cannot x: no");
}

TEST(ErrorOfACall, ShowsNoControlCharacters) {
  EXPECT_EQ(ToError({grpc::StatusCode::NOT_FOUND, "a\x1b[31m\nb"}, "x").message, "cannot x: a [31m b");
}

// gRPC escapes all but printable ASCII and drops calls with more than 8 KB of headers.
TEST(StatusOfAnError, FitsIntoTheHeadersOfACall) {
  std::string accents;
  for (int i = 0; i < 4000; ++i) accents += "\xc3\xa9";
  for (const std::string& text : {accents, std::string(100'000, '\xff'), std::string(5000, '%')}) {
    const std::string message = ToStatus(BadInput(text)).error_message();
    EXPECT_TRUE(IsUtf8(message));
    EXPECT_LE(3 * message.size(), 7u << 10);
    EXPECT_GT(message.size(), 1000u);
  }
}

}  // namespace
}  // namespace tessera
