#include "worker/shared_workload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/worker/tiny_scene.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using Clock = SharedWorkload::Clock;

constexpr auto kNews = SharedWorkload::News::kYes;

// A workload whose only scene is ready, as the loader thread would leave it.
class SharedWorkloadTest : public testing::Test {
 protected:
  SharedWorkloadTest() : workload_([this] { ++news_; }), order_(MakeOrder(blobs_, kTinyScene)) {
    workload_.Change()->Apply({{order_}, {}, {}, {}, {}, {}, {}}, Clock::now());
    const auto task = workload_.AwaitLoaderTask({});
    const auto* const order = std::get_if<SceneRequest>(&*task);
    workload_.Change(kNews)->SceneLoaded(order->key, *LoadOrderedScene(*order, blobs_.Fetcher()));
  }
  Lease MakeLease(uint64_t id) const {
    return {LeaseId{id}, {JobId{1}, 0, 0, {0, 4}, order_.key}, {0, 0, 8, 8}, {}, milliseconds(3000)};
  }
  void Finish(const UnitTask& task) {
    workload_.Change()->UnitFinished({task.lease.id, task.lease.unit, "sums", 0.1}, Clock::now());
  }
  WorkerState State() const {
    WorkerState state;
    workload_.FillState(state);
    return state;
  }
  std::vector<FinishedUnit> Results(size_t bytes_max = 1 << 20) {
    return std::get<std::vector<FinishedUnit>>(workload_.AwaitBatch(bytes_max, {}));
  }

  std::atomic<int> news_ = 0;
  BlobMap blobs_;
  SharedWorkload workload_;
  SceneRequest order_;
};

TEST_F(SharedWorkloadTest, AUnitGoesFromLeaseToAcknowledgedResult) {
  EXPECT_EQ(news_, 1);  // the scene is ready
  workload_.Change()->AddLeases({}, {MakeLease(1)}, {}, Clock::now());
  const auto task = workload_.AwaitUnit({});
  ASSERT_TRUE(task);
  EXPECT_NE(task->scene, nullptr);
  Finish(*task);
  EXPECT_EQ(State().leases[0].stage, LeaseStage::kReturning);
  const auto results = Results();
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].tile, "sums");
  EXPECT_EQ(Results().size(), 1u);  // sent again until it is acknowledged
  EXPECT_FALSE(workload_.AwaitIdle(milliseconds(0)));
  workload_.Change()->ResultsAnswered(results);
  EXPECT_TRUE(State().leases.empty());
  EXPECT_TRUE(workload_.AwaitIdle(milliseconds(0)));
}

TEST_F(SharedWorkloadTest, ResultsAreSentInBatchesOfBoundedSize) {
  for (uint64_t id : {1, 2, 3}) workload_.Change()->AddLeases({}, {MakeLease(id)}, {}, Clock::now());
  for (int i = 0; i < 3; ++i) Finish(*workload_.AwaitUnit({}));
  EXPECT_EQ(Results(8).size(), 3u);  // 4 bytes each beyond the first
  EXPECT_EQ(Results(7).size(), 2u);
  EXPECT_EQ(Results(0).size(), 1u);
}

TEST_F(SharedWorkloadTest, AtAnotherFarmAllWorkOfTheFirstIsForgotten) {
  WorkerDirective directive{
      {order_}, {MakeLease(1), MakeLease(2), MakeLease(3), MakeLease(4)}, {}, {}, {}, {}, {}, {1, 1}};
  workload_.Change()->Apply(directive, Clock::now());
  EXPECT_EQ(State().farm, (FarmId{1, 1}));
  const auto running = workload_.AwaitUnit({});
  const auto failing = workload_.AwaitUnit({});
  Finish(*workload_.AwaitUnit({}));
  const auto results = Results();
  EXPECT_EQ(results.at(0).farm, (FarmId{1, 1}));

  workload_.Change()->AddLeases({2, 2}, {MakeLease(5)}, {LeaseId{1}}, Clock::now());
  EXPECT_EQ(State().leases.size(), 4u) << "answers to results do not change the farm";

  directive.leases = {MakeLease(3)};  // the same number
  directive.farm = {2, 2};
  workload_.Change()->Apply(directive, Clock::now());
  EXPECT_EQ(State().farm, (FarmId{2, 2}));
  EXPECT_TRUE(*running->stop);
  ASSERT_EQ(State().leases.size(), 1u);
  EXPECT_EQ(State().leases[0].id, LeaseId{3});
  EXPECT_EQ(State().leases[0].stage, LeaseStage::kWaiting) << "it is a new lease";
  EXPECT_TRUE(State().scenes.at(0).ready) << "scenes are named by what they are made of";
  // What was under way is of no interest any more.
  Finish(*running);
  workload_.Change()->UnitFailed(failing->lease, "too late");
  workload_.Change()->ResultsAnswered(results);
  EXPECT_FALSE(workload_.Change()->HasBatch());
}

TEST_F(SharedWorkloadTest, AnAcknowledgedFailureIsForgottenAndNoOther) {
  workload_.Change()->AddLeases({}, {MakeLease(1), MakeLease(2)}, {}, Clock::now());
  const auto one = workload_.AwaitUnit({}), two = workload_.AwaitUnit({});
  workload_.Change()->UnitFailed(one->lease, "first");
  const auto first = std::get<FailureReport>(workload_.AwaitBatch(0, {}));
  workload_.Change()->UnitFailed(two->lease, "second");
  workload_.Change()->FailureAnswered(first);
  workload_.Change()->FailureAnswered(first);  // copies are harmless
  EXPECT_EQ(std::get<FailureReport>(workload_.AwaitBatch(0, {})).reason, "second");
}

TEST_F(SharedWorkloadTest, ADroppedLeaseIsForgottenAtEveryStage) {
  workload_.Change()->AddLeases({}, {MakeLease(1), MakeLease(2), MakeLease(3)}, {}, Clock::now());
  const auto running = workload_.AwaitUnit({});
  Finish(*workload_.AwaitUnit({}));
  workload_.Change()->AddLeases({}, {}, {LeaseId{1}, LeaseId{2}, LeaseId{3}}, Clock::now());
  EXPECT_TRUE(*running->stop);
  Finish(*running);  // too late
  EXPECT_TRUE(State().leases.empty());
  EXPECT_TRUE(workload_.AwaitIdle(milliseconds(0)));
}

TEST_F(SharedWorkloadTest, ALeaseForASceneThatIsNotExpectedIsReturned) {
  Lease lease = MakeLease(1);
  lease.unit.scene = {};
  workload_.Change()->AddLeases({}, {lease}, {}, Clock::now());
  EXPECT_TRUE(State().leases.empty());
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{1}));
  workload_.Change()->ReturnsAcknowledged({LeaseId{1}});
  EXPECT_TRUE(State().returned_leases.empty());
}

TEST_F(SharedWorkloadTest, ASceneThatFailsReturnsItsLeasesAndIsReported) {
  const SceneRequest bad = MakeOrder(blobs_, "WorldBegin\nnonsense\n");
  workload_.Change()->Apply({{order_, bad}, {}, {}, {}, {}, {}, {}}, Clock::now());
  Lease lease = MakeLease(1);
  lease.unit.scene = bad.key;
  workload_.Change()->AddLeases({}, {lease}, {}, Clock::now());
  EXPECT_EQ(std::get<SceneRequest>(*workload_.AwaitLoaderTask({})).key, bad.key);
  workload_.Change(kNews)->SceneFailed(bad.key, "nonsense in it", FailureCause::kScene, Clock::now());
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{1}));
  const auto report = std::get<FailureReport>(workload_.AwaitBatch(0, {}));
  EXPECT_EQ(report.lease, LeaseId{});
  EXPECT_EQ(report.scene, bad.key);
  EXPECT_EQ(report.reason, "nonsense in it");
}

TEST_F(SharedWorkloadTest, DrainingReturnsWhatWaitsAndFinishesWhatRuns) {
  workload_.Change()->AddLeases({}, {MakeLease(1), MakeLease(2)}, {}, Clock::now());
  const auto task = workload_.AwaitUnit({});
  workload_.Change(kNews)->Drain();
  EXPECT_TRUE(State().draining);
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{2}));
  workload_.Change()->AddLeases({}, {MakeLease(3)}, {}, Clock::now());  // was on its way
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{2}, LeaseId{3}));
  workload_.Change()->ReturnsAcknowledged({LeaseId{2}, LeaseId{3}});
  EXPECT_FALSE(*task->stop);
  Finish(*task);
  const auto results = Results();
  workload_.Change()->ResultsAnswered(results);
  EXPECT_TRUE(workload_.AwaitIdle(milliseconds(0)));
}

TEST_F(SharedWorkloadTest, StoppingReturnsWhatRuns) {
  workload_.Change()->AddLeases({}, {MakeLease(1)}, {}, Clock::now());
  const auto task = workload_.AwaitUnit({});
  workload_.Change(kNews)->StopRendering();
  EXPECT_TRUE(*task->stop);
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{1}));
}

TEST_F(SharedWorkloadTest, TheStateIsReportedSeveralTimesDuringALease) {
  EXPECT_EQ(State().wait, kSynchronizeWaitMax);
  workload_.Change()->AddLeases({}, {MakeLease(1)}, {}, Clock::now());
  EXPECT_EQ(State().wait, milliseconds(1000));  // a third of its 3 s
}

TEST_F(SharedWorkloadTest, WaitingEndsWhenAStopIsRequested) {
  std::stop_source stop;
  std::thread slot([&] { EXPECT_FALSE(workload_.AwaitUnit(stop.get_token())); });
  std::thread loader([&] { EXPECT_FALSE(workload_.AwaitLoaderTask(stop.get_token())); });
  std::thread returner([&] {
    EXPECT_TRUE(std::holds_alternative<std::monostate>(workload_.AwaitBatch(0, stop.get_token())));
  });
  stop.request_stop();
  slot.join();
  loader.join();
  returner.join();
}

}  // namespace
}  // namespace tessera
