// Calls that change something while the disk of the coordinator takes nothing: the client gets the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;

class FullDisk : public Services {
 protected:
  grpc::Status Change(grpc::Status (proto::Jobs::Stub::*method)(grpc::ClientContext*,
                                                                const proto::JobRequest&, proto::JobStatus*),
                      uint64_t job) {
    proto::JobRequest request;
    request.set_job(job);
    proto::JobStatus status;
    return Call(*jobs, method, request, status);
  }
  grpc::Status SetPriority(uint64_t job, int priority) {
    proto::PriorityRequest request;
    request.set_job(job);
    request.set_priority(priority);
    proto::JobStatus status;
    return Call(*jobs, &proto::Jobs::Stub::SetPriority, request, status);
  }
  grpc::Status Extend(uint64_t job) {
    proto::ExtendRequest request;
    request.set_job(job);
    request.set_samples_per_pixel(8);
    proto::JobStatus status;
    return Call(*jobs, &proto::Jobs::Stub::Extend, request, status);
  }
  grpc::Status SubmitAnother() {
    proto::JobSpec job = another;
    proto::SubmitAnswer answer;
    return Call(*jobs, &proto::Jobs::Stub::Submit, job, answer);
  }
  grpc::Status ChangeWorkers(grpc::Status (proto::Jobs::Stub::*method)(grpc::ClientContext*,
                                                                       const proto::WorkersRequest&,
                                                                       proto::WorkersAnswer*)) {
    proto::WorkersRequest request;
    request.set_which("tester");
    proto::WorkersAnswer answer;
    return Call(*jobs, method, request, answer);
  }
  // Every call that changes something that survives a restart.
  std::map<std::string, std::function<grpc::Status()>> Changes(uint64_t job) {
    using Stub = proto::Jobs::Stub;
    return {{"submit", [this] { return SubmitAnother(); }},
            {"pause", [=, this] { return Change(&Stub::Pause, job); }},
            {"resume", [=, this] { return Change(&Stub::Resume, job); }},
            {"cancel", [=, this] { return Change(&Stub::Cancel, job); }},
            {"priority", [=, this] { return SetPriority(job, 9); }},
            {"extend", [=, this] { return Extend(job); }},
            {"drain", [this] { return ChangeWorkers(&Stub::DrainWorkers); }},
            {"release", [this] { return ChangeWorkers(&Stub::ReleaseWorkers); }}};
  }
  // An extendable job, and another one to submit.
  uint64_t Prepare() {
    proto::JobSpec job = PrepareJob();
    job.mutable_frames(0)->set_extendable(true);
    another = job;
    another.set_submission(43);
    proto::SubmitAnswer answer;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Submit, job, answer).ok());
    proto::WorkerDirective directive;
    EXPECT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
    return answer.job();
  }
  proto::JobSpec another;
};

TEST_F(FullDisk, EveryChangeIsRefusedWithTheReasonWithinSecondsAndChangesNothing) {
  const uint64_t job = Prepare();
  const auto changes = Changes(job);
  {
    const NoFileGrows full;
    EXPECT_FALSE(SetPriority(job, 3).ok());  // from now on the coordinator knows of the disk
    for (const auto& [name, change] : changes) {
      const auto start = std::chrono::steady_clock::now();
      const grpc::Status status = change();
      EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << name;
      EXPECT_EQ(status.error_code(), StatusCode::RESOURCE_EXHAUSTED)
          << name << ": " << status.error_message();
      EXPECT_THAT(status.error_message(), HasSubstr("cannot write its data")) << name;
      EXPECT_THAT(status.error_message(), HasSubstr("File too large")) << name;
    }
    EXPECT_EQ(Status(job).state(), proto::JOB_STATE_PAUSED) << "by the disk";
    EXPECT_FALSE(Status(job).paused_by_user());
  }
  grpc::Status recovered;
  for (int attempt = 0; attempt < 50 && !(recovered = SetPriority(job, 4)).ok(); ++attempt)
    std::this_thread::sleep_for(milliseconds(100));
  EXPECT_TRUE(recovered.ok()) << recovered.error_message();
  EXPECT_EQ(Status(job).priority(), 4);
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_WAITING);
  proto::ListAnswer list;
  ASSERT_TRUE(Call(*jobs, &proto::Jobs::Stub::List, proto::ListRequest(), list).ok());
  EXPECT_EQ(list.jobs_size(), 1) << "the refused job is not there";
}

TEST_F(FullDisk, AChangeThatFindsTheDiskFullWhileItIsWrittenIsAnsweredAndWrittenLater) {
  for (const auto& [name, unused] : Changes(0)) {
    current_dir = name;
    coordinator.reset();
    Start();
    const uint64_t job = Prepare();
    const auto changes = Changes(job);
    if (name == "release") {
      ASSERT_TRUE(changes.at("drain")().ok());
    }
    if (name == "resume") {
      ASSERT_TRUE(changes.at("pause")().ok());
    }
    {
      const NoFileGrows full;
      const auto start = std::chrono::steady_clock::now();
      const grpc::Status status = changes.at(name)();
      EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << name;
      EXPECT_EQ(status.error_code(), StatusCode::RESOURCE_EXHAUSTED) << name;
      EXPECT_THAT(status.error_message(), HasSubstr("File too large")) << name;
      EXPECT_THAT(status.error_message(), HasSubstr("takes effect when it can be written")) << name;
    }
    grpc::Status recovered;
    for (int attempt = 0; attempt < 50 && !(recovered = changes.at("submit")()).ok(); ++attempt)
      std::this_thread::sleep_for(milliseconds(100));
    EXPECT_TRUE(recovered.ok()) << name << ": " << recovered.error_message();
  }
}

}  // namespace
}  // namespace tessera
