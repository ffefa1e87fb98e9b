// A job belongs to whoever submitted it, over real connections.
#include "tests/coordinator/members_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class JobOwners : public ServicesForMembers {
 protected:
  // Makes every call that changes a job or reads what it rendered. Returns their statuses.
  std::map<std::string, grpc::Status> Touch(uint64_t job) {
    std::map<std::string, grpc::Status> statuses;
    proto::JobRequest request;
    request.set_job(job);
    proto::PriorityRequest priority;
    priority.set_job(job);
    priority.set_priority(3);
    proto::ExtendRequest extend;
    extend.set_job(job);
    extend.set_samples_per_pixel(4);
    proto::JobStatus answer;
    statuses["Pause"] = Call(*jobs, &proto::Jobs::Stub::Pause, request, answer);
    statuses["Resume"] = Call(*jobs, &proto::Jobs::Stub::Resume, request, answer);
    statuses["SetPriority"] = Call(*jobs, &proto::Jobs::Stub::SetPriority, priority, answer);
    statuses["Extend"] = Call(*jobs, &proto::Jobs::Stub::Extend, extend, answer);
    std::string bytes;
    statuses["FetchPicture"] = Fetch(job, true, bytes);
    statuses["Cancel"] = Call(*jobs, &proto::Jobs::Stub::Cancel, request, answer);
    return statuses;
  }
  void ExpectDenied(uint64_t job, const std::string& message) {
    for (const auto& [call, status] : Touch(job)) {
      EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED) << call;
      EXPECT_THAT(status.error_message(), HasSubstr("Jobs." + call)) << call;
      EXPECT_THAT(status.error_message(), HasSubstr(message)) << call;
    }
  }
  void ExpectAllowed(uint64_t job) {
    for (const auto& [call, status] : Touch(job))
      EXPECT_NE(status.error_code(), grpc::StatusCode::PERMISSION_DENIED) << call << status.error_message();
  }

  const JoinedFarm ada = Join(Role::kUser, "ada"), bob = Join(Role::kUser, "bob");
};

TEST_F(JobOwners, AUserTouchesOnlyItsOwnJobs) {
  CallAs(ada);
  const uint64_t job = Submit();
  EXPECT_EQ(Status(job).owner(), "ada");
  EXPECT_EQ(Status(job).owner_member(), Number(ada.member));
  CallAs(bob);
  ExpectDenied(job, "which belongs to \"ada\"; ask its owner or an operator");
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_WAITING) << "a user looks at all jobs";
  EXPECT_EQ(Status(job).priority(), 0);
  CallAs(ada);
  ExpectAllowed(job);
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_CANCELLED);
}

TEST_F(JobOwners, AnOperatorTouchesAllJobs) {
  CallAs(ada);
  const uint64_t job = Submit();
  CallAs(Join(Role::kOperator, "root"));
  ExpectAllowed(job);
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_CANCELLED);
}

TEST_F(JobOwners, TheSameNameIsNotTheSameOwner) {
  CallAs(ada);
  const uint64_t job = Submit();
  CallAs(Join(Role::kUser, "ada"));
  ExpectDenied(job, "which belongs to \"ada\"");
}

TEST_F(JobOwners, JobsOfTheLocalUserAreThoseOfNoMember) {
  const uint64_t job = Submit();
  EXPECT_EQ(Status(job).owner(), "local");
  EXPECT_EQ(Status(job).owner_member(), 0u);
  CallAs(ada);
  ExpectDenied(job, "which belongs to \"local\"");
}

TEST_F(JobOwners, AnOwnerKeepsItsJobsOverARestartAndARenewedCertificate) {
  CallAs(ada);
  const uint64_t job = Submit();
  JoinedFarm renewed = ada;
  renewed.identity.key = PrivateKey::Generate();
  proto::RenewRequest request;
  request.set_signing_request(MakeSigningRequest(renewed.identity.key));
  proto::RenewAnswer answer;
  ASSERT_TRUE(Call(*access, &proto::Access::Stub::Renew, request, answer).ok());
  renewed.identity.certificate_pem = answer.certificate();
  Restart();
  CallAs(renewed);
  EXPECT_EQ(Status(job).owner(), "ada");
  ExpectAllowed(job);
}

TEST_F(JobOwners, TheSubmissionOfAnotherIsNotAnswered) {
  CallAs(ada);
  const uint64_t job = Submit();
  EXPECT_EQ(Submit(), job) << "the same submission is the same job";
  CallAs(bob);
  proto::SubmitAnswer answer;
  const grpc::Status status = Call(*jobs, &proto::Jobs::Stub::Submit, PrepareJob(), answer);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("another owner"));
  EXPECT_EQ(answer.job(), 0u);
}

}  // namespace
}  // namespace tessera
