// The address of a coordinator comes to lead to another farm, or to another history of the same one, while a
// client is connected: job numbers mean other jobs there.
#include <gmock/gmock.h>

#include <filesystem>
#include <thread>

#include "client/coordinator/coordinator_client.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr const char* kAnotherFarm = "another farm";

template <typename T>
Result<void> Outcome(const Result<T>& result) {
  return result ? Result<void>() : result.error();
}

class FarmChange : public Services {
 protected:
  FarmChange() { client_ = NewClient(); }
  std::unique_ptr<CoordinatorClient> NewClient() {
    auto client = CoordinatorClient::Connect(*ParseAddress("unix:" + (folder / "socket"), "test"),
                                             {kPatience, kPatience}, {});
    EXPECT_TRUE(client) << client.error().message;
    return std::move(*client);
  }
  // From now on the coordinator at the address uses this data directory.
  void ChangeTo(const std::string& data_dir) {
    coordinator.reset();
    current_dir = data_dir;
    Start();
  }
  // A job with another submission than that of Submit.
  uint64_t SubmitAnother() {
    proto::JobSpec spec = PrepareJob();
    spec.set_submission(43);
    proto::SubmitAnswer answer;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Submit, spec, answer).ok());
    return answer.job();
  }
  void Finish(uint64_t job) {
    proto::ResultsAnswer answer;
    for (const uint32_t tile : {0u, 1u}) ASSERT_TRUE(Return(job, tile, {0, 4}, answer).ok());
    while (Status(job).state() != proto::JOB_STATE_FINISHED) std::this_thread::sleep_for(milliseconds(5));
  }
  // Watches the job and calls `change` after the first status.
  Result<JobStatus> WatchAcross(uint64_t job, const std::function<void()>& change) {
    bool is_changed = false;
    return client_->Watch(JobId{job}, [&](const JobStatus&) {
      if (!std::exchange(is_changed, true)) change();
    });
  }

  std::unique_ptr<CoordinatorClient> client_;
};

TEST_F(FarmChange, EveryCallForTheFirstFarmIsRefusedByTheSecond) {
  const uint64_t job = Submit();
  Finish(job);
  ASSERT_TRUE(client_->Frames(JobId{job}));
  ChangeTo("other");
  ASSERT_EQ(Submit(), job) << "the same number at the other farm";
  Finish(job);
  const JobId id{job};
  const PackedScene scene;
  uint64_t left_out = 0;
  const std::vector<Result<void>> outcomes{
      Outcome(client_->Status(id)),
      Outcome(client_->Frames(id)),
      Outcome(client_->FetchPicture(id, 0, false, folder.path())),
      Outcome(client_->FetchPicture(id, 0, true, folder.path())),
      Outcome(client_->Watch(id, [](const JobStatus&) { FAIL() << "a status of the other farm's job"; })),
      Outcome(client_->Cancel(id)),
      Outcome(client_->Extend(id, 8)),
      Outcome(client_->Pause(id)),
      Outcome(client_->Resume(id)),
      Outcome(client_->SetPriority(id, 3)),
      Outcome(client_->Jobs(left_out)),
      Outcome(client_->Workers(left_out)),
      Outcome(client_->Drain("any", left_out)),
      Outcome(client_->Release("any", left_out)),
      Outcome(client_->Submit(scene, {})),
      Outcome(client_->Upload(scene)),
  };
  for (size_t i = 0; i < outcomes.size(); ++i) {
    ASSERT_FALSE(outcomes[i]) << i;
    EXPECT_THAT(outcomes[i].error().message, HasSubstr(kAnotherFarm)) << i;
    EXPECT_EQ(outcomes[i].error().kind, ErrorKind::kFailed) << i;
  }
  EXPECT_TRUE(NewClient()->FetchPicture(id, 0, false, folder.path()))
      << "a client that connects now means the other farm";
}

TEST_F(FarmChange, AWatchedJobIsNotFollowedToAnotherFarm) {
  const uint64_t job = Submit();
  const auto last = WatchAcross(job, [&] {
    ChangeTo("other");
    ASSERT_EQ(Submit(), job);
    Finish(job);
  });
  ASSERT_FALSE(last) << "the other farm's job has finished";
  EXPECT_THAT(last.error().message, HasSubstr(kAnotherFarm));
}

TEST_F(FarmChange, AWatchedJobIsFollowedOverARestartAndAChangeOfTheAddressBackAndForth) {
  const uint64_t job = Submit();
  const auto last = WatchAcross(job, [&] {
    ChangeTo("data");
    Finish(job);
  });
  ASSERT_TRUE(last) << last.error().message;
  EXPECT_EQ(last->state, JobState::kFinished);
  ChangeTo("other");
  ChangeTo("data");
  EXPECT_TRUE(client_->FetchPicture(JobId{job}, 0, false, folder.path()));
}

class RestoredFarm : public FarmChange {
 protected:
  // Runs the coordinator on a copy of the directory from before there was any job.
  void BackUp() {
    ChangeTo("data");
    coordinator.reset();
    std::filesystem::copy(folder / "data", folder / "backup", std::filesystem::copy_options::recursive);
    Start();
  }
  void Restore() { ChangeTo("backup"); }
};

TEST_F(RestoredFarm, AnotherJobOfTheSameNumberIsNotWatchedInstead) {
  BackUp();
  const uint64_t job = Submit();
  const auto last = WatchAcross(job, [&] {
    Restore();
    ASSERT_EQ(SubmitAnother(), job);
    Finish(job);
  });
  ASSERT_FALSE(last);
  EXPECT_THAT(last.error().message, HasSubstr("is the number of another job now"));
}

TEST_F(RestoredFarm, AWatchedJobThatIsGoneIsAFailureOfTheFarm) {
  BackUp();
  const auto last = WatchAcross(Submit(), [&] { Restore(); });
  ASSERT_FALSE(last);
  EXPECT_EQ(last.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(last.error().message, HasSubstr("restored to an earlier state"));
}

}  // namespace
}  // namespace tessera
