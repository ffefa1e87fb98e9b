// The log of a job over gRPC: followed from one call to the next, and there after a restart.
#include <gmock/gmock.h>

#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class JobLogCall : public Services {
 protected:
  grpc::Status Read(uint64_t job, uint64_t after, proto::JobLogAnswer& answer, uint32_t limit = 0) {
    proto::JobLogRequest request;
    request.set_job(job);
    request.set_after(after);
    request.set_limit(limit);
    return Call(*jobs, &proto::Jobs::Stub::JobLog, request, answer);
  }
};

TEST_F(JobLogCall, IsFollowedUntilTheJobHasEndedAndOutlivesARestart) {
  const uint64_t job = Submit();
  proto::JobLogAnswer answer;
  ASSERT_TRUE(Read(job, 0, answer).ok());
  ASSERT_EQ(answer.entries_size(), 1);
  EXPECT_THAT(answer.entries(0).text(), HasSubstr("submitted"));
  EXPECT_FALSE(answer.has_ended());
  const uint64_t first = answer.entries(0).number();
  proto::JobRequest request;
  request.set_job(job);
  proto::JobStatus status;
  ASSERT_TRUE(Call(*jobs, &proto::Jobs::Stub::Cancel, request, status).ok());
  ASSERT_TRUE(Read(job, first, answer).ok());
  ASSERT_EQ(answer.entries_size(), 1);
  EXPECT_EQ(answer.entries(0).text(), "cancelled");
  EXPECT_TRUE(answer.has_ended());

  coordinator.reset();
  Start();
  ASSERT_TRUE(Read(job, 0, answer).ok());
  ASSERT_EQ(answer.entries_size(), 2);
  EXPECT_EQ(answer.entries(0).number(), first);
  EXPECT_TRUE(answer.has_ended());
}

TEST_F(JobLogCall, RefusesUnknownJobsAndLimits) {
  proto::JobLogAnswer answer;
  EXPECT_EQ(Read(7, 0, answer).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Read(Submit(), 0, answer, 1001).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

}  // namespace
}  // namespace tessera
