#include "coordinator/message_guard.h"

#include <gtest/gtest.h>

#include "proto/blobs.pb.h"
#include "proto/jobs.pb.h"
#include "proto/work.pb.h"

namespace tessera {
namespace {

// Parses the bytes as they arrive: in two slices.
grpc::Status Parse(const std::string& bytes, google::protobuf::Message& message, size_t elements_max = 100) {
  const size_t half = bytes.size() / 2;
  const grpc::Slice slices[] = {{bytes.data(), half}, {bytes.data() + half, bytes.size() - half}};
  grpc::ByteBuffer buffer(slices, 2);
  return ParseMessage(buffer, {1000, elements_max}, message);
}

TEST(MessageGuard, AcceptsAMessageWithinTheLimits) {
  proto::WorkersRequest request, parsed;
  request.set_which("bl\xc3\xa4tt");
  EXPECT_TRUE(Parse(request.SerializeAsString(), parsed).ok());
  EXPECT_EQ(parsed.which(), "bl\xc3\xa4tt");
}

TEST(MessageGuard, RefusesTextThatIsNotUtf8WithAReason) {
  proto::FailureRequest parsed;
  // Field 5, the reason, of four bytes: the first three of a character of four, and a letter.
  const grpc::Status status = Parse("\x2a\x04\xf0\x9f\x98r", parsed);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(status.error_message(), "message refused: it contains text that is not UTF-8");
  // Also in a message of a message: the channel's name of a frame of a job.
  const std::string channel("\x0a\x01\xff", 3), spec = "\x5a\x03" + channel, frame = "\x1a\x05" + spec;
  proto::JobSpec job;
  EXPECT_EQ(Parse("\x2a\x07" + frame, job).error_message(), status.error_message());
}

TEST(MessageGuard, AcceptsAnyBytesWhereNoTextIsExpected) {
  proto::FailureRequest request, parsed;
  request.set_scene("\xff\xfe");
  EXPECT_TRUE(Parse(request.SerializeAsString(), parsed).ok());
}

TEST(MessageGuard, RefusesMoreElementsThanTheLimit) {
  proto::JobSpec request, parsed;
  for (int i = 0; i < 10; ++i) request.add_required_tags("gpu");
  EXPECT_TRUE(Parse(request.SerializeAsString(), parsed, 10).ok());
  const grpc::Status status = Parse(request.SerializeAsString(), parsed, 9);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
}

TEST(MessageGuard, RefusesATruncatedMessage) {
  proto::WorkersRequest request, parsed;
  request.set_which("blade");
  const std::string bytes = request.SerializeAsString();
  EXPECT_EQ(Parse(bytes.substr(0, bytes.size() - 1), parsed).error_message(),
            "message refused: it is malformed");
}

TEST(MessageGuard, RefusesFieldsWithoutANumber) {
  proto::FailureRequest parsed;
  EXPECT_EQ(Parse(std::string("\x05\0\0\0\0", 5), parsed).error_message(),
            "message refused: it is malformed");
}

TEST(MessageGuard, RefusesTagsAndSizesOfMoreThanFiveBytes) {
  proto::FailureRequest parsed;
  const std::string tag("\x88\x80\x80\x80\x80\x00\x01", 7), size("\x2a\x81\x80\x80\x80\x80\x00r", 8);
  for (const std::string& bytes : {tag, size})
    EXPECT_EQ(Parse(bytes, parsed).error_message(), "message refused: it is malformed");
}

TEST(MessageGuard, RefusesPackedNumbersThatAreCutOff) {
  proto::FindMissingAnswer answer, parsed;
  for (const uint64_t held : {1, 200, 3}) answer.add_held(held);
  EXPECT_TRUE(Parse(answer.SerializeAsString(), parsed).ok());
  EXPECT_EQ(parsed.held_size(), 3);
  // Field 2, packed: the last of two bytes announces another.
  EXPECT_EQ(Parse("\x12\x02\x01\x80", parsed).error_message(), "message refused: it is malformed");
}

TEST(MessageGuard, RefusesASubmessageThatIsLongerThanItsMessage) {
  // Field 5, a frame of 4 bytes, which contains field 3 of 9 bytes; there are 11.
  proto::JobSpec parsed;
  const std::string bytes("\x2a\x04\x1a\x09\x08\x04\x10\x04\x08\x04\x10\x04\x08", 13);
  EXPECT_EQ(Parse(bytes, parsed).error_message(), "message refused: it is malformed");
}

TEST(MessageGuard, RefusesAMessageThatEndsWithinASubmessage) {
  // Field 6, a lease of 9 bytes, of which two arrive.
  proto::FailureRequest parsed;
  EXPECT_EQ(Parse("\x32\x09\x08\x01", parsed).error_message(), "message refused: it is malformed");
}

}  // namespace
}  // namespace tessera
