// Calls that change something while the disk of the coordinator takes nothing: the client gets the reason.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>

#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/services_fixture.h"
#include "tests/small_disk.h"

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

TEST_F(FullDisk, EveryChangeThatFreesNoSpaceIsRefusedWithTheReasonWithinSecondsAndChangesNothing) {
  const uint64_t job = Prepare();
  auto changes = Changes(job);
  changes.erase("cancel");
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

// On a file system that can be filled.
class FullFileSystem : public FullDisk {
 protected:
  void SetUp() override {
    if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
    coordinator.reset();
    current_dir = "small";
    Start();
    coordinator.reset();
    Start();
  }
  uint64_t SubmitSecond() {
    proto::SubmitAnswer answer;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Submit, another, answer).ok());
    return answer.job();
  }
  // Returns the first units of a job, whose answer waits for the disk.
  std::thread ReturnLater(uint64_t job) {
    return std::thread([this, job] {
      proto::ResultsAnswer answer;
      const grpc::Status status = Return(job, 0, {0, 4}, answer);
      EXPECT_TRUE(status.ok()) << status.error_message();
    });
  }
  void AwaitFullDisk(uint64_t job) {
    ASSERT_TRUE(Eventually([&] { return Status(job).reason().find("No space left") != std::string::npos; }));
  }
  bool HasSums(uint64_t job) const {
    return std::filesystem::exists(folder / fmt::format("small/spool/{}-0", job));
  }
  template <typename Condition>
  static bool Eventually(Condition condition) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!condition() && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(milliseconds(20));
    return condition();
  }
  void Restart() {
    coordinator.reset();
    Start();
  }
  const std::string path = folder / "small";
  const SmallDisk disk{path};
};

TEST_F(FullFileSystem, AJobIsCancelledItsSumsAreRemovedAndOthersWaitForTheSpace) {
  const uint64_t first = Prepare(), second = SubmitSecond();
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(first, 0, {0, 2}, answer).ok());
  ASSERT_TRUE(HasSums(first));
  disk.Fill();
  std::thread waiting = ReturnLater(second);
  AwaitFullDisk(second);
  const grpc::Status cancelled = Change(&proto::Jobs::Stub::Cancel, first);
  EXPECT_TRUE(cancelled.ok()) << cancelled.error_message();
  EXPECT_EQ(Status(first).state(), proto::JOB_STATE_CANCELLED);
  EXPECT_FALSE(HasSums(first));
  EXPECT_FALSE(SetPriority(second, 3).ok()) << "what frees no space waits";
  disk.Free();
  waiting.join();
  Restart();
  EXPECT_EQ(Status(first).state(), proto::JOB_STATE_CANCELLED);
  EXPECT_EQ(Status(second).samples_done(), 64u * 4) << "acknowledged";
  EXPECT_TRUE(HasSums(second));
}

TEST_F(FullFileSystem, ACancelledJobWhoseResultsCannotBeWrittenStaysCancelledAfterACrash) {
  const uint64_t job = Prepare();
  disk.Fill();
  std::thread waiting = ReturnLater(job);
  AwaitFullDisk(job);
  EXPECT_TRUE(Change(&proto::Jobs::Stub::Cancel, job).ok());
  // What is on stable storage at this moment is what a crash would leave.
  std::filesystem::copy(folder / "small", folder / "crashed", std::filesystem::copy_options::recursive);
  waiting.join();
  coordinator.reset();
  current_dir = "crashed";
  Start();
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_CANCELLED);
}

TEST_F(FullFileSystem, TheWatcherOfACancelledJobLearnsOfItsEnd) {
  const uint64_t job = Prepare(), second = SubmitSecond();
  disk.Fill();
  std::thread waiting = ReturnLater(second);
  AwaitFullDisk(second);
  grpc::ClientContext context;
  SetDeadline(context, kPatience);
  proto::JobRequest request;
  request.set_job(job);
  const auto watch = jobs->Watch(&context, request);
  EXPECT_TRUE(Change(&proto::Jobs::Stub::Cancel, job).ok());
  proto::JobStatus status;
  while (watch->Read(&status)) {
  }
  EXPECT_TRUE(watch->Finish().ok());
  EXPECT_EQ(status.state(), proto::JOB_STATE_CANCELLED);
  disk.Free();
  waiting.join();
}

TEST_F(FullFileSystem, CancellingIsPossibleAfterARestart) {
  const uint64_t job = Prepare();
  disk.Fill();
  Restart();
  EXPECT_TRUE(Change(&proto::Jobs::Stub::Cancel, job).ok());
  Restart();
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_CANCELLED);
}

}  // namespace
}  // namespace tessera
