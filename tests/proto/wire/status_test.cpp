// Messages of errors arrive whatever their length.
#include <grpcpp/support/status.h>
#include <gtest/gtest.h>

#include "proto/wire/channel.h"

namespace tessera {
namespace {

grpc::Status StatusOf(const std::string& message) {
  return {grpc::StatusCode::NOT_FOUND, message};
}

TEST(Shortened, LeavesShortMessagesAsTheyAre) {
  EXPECT_EQ(Shortened(StatusOf("no such file")).error_message(), "no such file");
  const std::string path(4000, 'x');
  EXPECT_EQ(Shortened(StatusOf(path)).error_message(), path);
  EXPECT_TRUE(Shortened(grpc::Status::OK).ok());
}

TEST(Shortened, CutsLongMessagesBetweenCharacters) {
  std::string accents;
  for (int i = 0; i < 4000; ++i) accents += "\xc3\xa9";
  const grpc::Status status = Shortened(StatusOf(accents));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  const std::string& message = status.error_message();
  ASSERT_TRUE(message.ends_with(" ..."));
  EXPECT_EQ((message.size() - 4) % 2, 0u) << "no half characters";
  EXPECT_LT(3 * message.size(), 8000u);
  EXPECT_GT(3 * message.size(), 5000u);
}

}  // namespace
}  // namespace tessera
