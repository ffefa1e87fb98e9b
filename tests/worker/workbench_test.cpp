#include "worker/workbench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/worker/tiny_scene.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

// A workbench whose only scene is ready, as the loader's thread would leave it.
class WorkbenchTest : public testing::Test {
 protected:
  WorkbenchTest() : bench_([this] { ++news_; }), order_(MakeOrder(blobs_, kTinyScene)) {
    bench_.Apply({{order_}, {}, {}, {}, {}, {}});
    const auto order = bench_.AwaitSceneOrder({});
    bench_.SceneLoaded(order->key, *LoadOrderedScene(*order, blobs_.Fetcher()));
  }
  Lease MakeLease(uint64_t id) const {
    return {LeaseId{id}, {JobId{1}, 0, 0, {0, 4}}, {0, 0, 8, 8}, {}, order_.key, milliseconds(3000)};
  }
  void Finish(const UnitTask& task) { bench_.UnitFinished({task.lease.id, task.lease.unit, "sums", 0.1}); }
  WorkerState State() const {
    WorkerState state;
    bench_.FillState(state);
    return state;
  }
  std::vector<FinishedUnit> Results(size_t bytes_max = 1 << 20) {
    return std::get<std::vector<FinishedUnit>>(bench_.AwaitParcel(bytes_max, {}));
  }

  std::atomic<int> news_ = 0;
  BlobMap blobs_;
  Workbench bench_;
  SceneOrder order_;
};

TEST_F(WorkbenchTest, AUnitGoesFromLeaseToAnsweredResult) {
  EXPECT_EQ(news_, 1);  // the scene is ready
  bench_.AddLeases({MakeLease(1)}, {});
  const auto task = bench_.AwaitUnit({});
  ASSERT_TRUE(task);
  EXPECT_NE(task->scene, nullptr);
  Finish(*task);
  EXPECT_EQ(State().leases[0].stage, LeaseStage::kReturning);
  const auto results = Results();
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].tile, "sums");
  EXPECT_EQ(Results().size(), 1u);  // until it is answered it is sent again
  EXPECT_FALSE(bench_.AwaitIdle(milliseconds(0)));
  bench_.ResultsAnswered(results);
  EXPECT_TRUE(State().leases.empty());
  EXPECT_TRUE(bench_.AwaitIdle(milliseconds(0)));
}

TEST_F(WorkbenchTest, ResultsTravelInBatchesOfBoundedSize) {
  for (uint64_t id : {1, 2, 3}) bench_.AddLeases({MakeLease(id)}, {});
  for (int i = 0; i < 3; ++i) Finish(*bench_.AwaitUnit({}));
  EXPECT_EQ(Results(8).size(), 3u);  // 4 bytes each beyond the first
  EXPECT_EQ(Results(7).size(), 2u);
  EXPECT_EQ(Results(0).size(), 1u);
}

TEST_F(WorkbenchTest, ADroppedLeaseIsForgottenAtEveryStage) {
  bench_.AddLeases({MakeLease(1), MakeLease(2), MakeLease(3)}, {});
  const auto running = bench_.AwaitUnit({});
  Finish(*bench_.AwaitUnit({}));
  bench_.AddLeases({}, {LeaseId{1}, LeaseId{2}, LeaseId{3}});
  EXPECT_TRUE(*running->stop);
  Finish(*running);  // too late
  EXPECT_TRUE(State().leases.empty());
  EXPECT_TRUE(bench_.AwaitIdle(milliseconds(0)));
}

TEST_F(WorkbenchTest, ALeaseForASceneThatIsNotExpectedIsReturned) {
  Lease lease = MakeLease(1);
  lease.scene = {};
  bench_.AddLeases({lease}, {});
  EXPECT_TRUE(State().leases.empty());
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{1}));
  bench_.ReturnsHeard({LeaseId{1}});
  EXPECT_TRUE(State().returned_leases.empty());
}

TEST_F(WorkbenchTest, ASceneThatFailsReturnsItsLeasesAndIsReported) {
  const SceneOrder bad = MakeOrder(blobs_, "WorldBegin\nnonsense\n");
  bench_.Apply({{order_, bad}, {}, {}, {}, {}, {}});
  Lease lease = MakeLease(1);
  lease.scene = bad.key;
  bench_.AddLeases({lease}, {});
  EXPECT_EQ(bench_.AwaitSceneOrder({})->key, bad.key);
  bench_.SceneFailed(bad.key, "nonsense in it");
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{1}));
  const auto report = std::get<FailureReport>(bench_.AwaitParcel(0, {}));
  EXPECT_EQ(report.lease, LeaseId{});
  EXPECT_EQ(report.scene, bad.key);
  EXPECT_EQ(report.reason, "nonsense in it");
}

TEST_F(WorkbenchTest, DrainingReturnsWhatWaitsAndFinishesWhatRuns) {
  bench_.AddLeases({MakeLease(1), MakeLease(2)}, {});
  const auto task = bench_.AwaitUnit({});
  bench_.Drain();
  EXPECT_TRUE(State().draining);
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{2}));
  bench_.AddLeases({MakeLease(3)}, {});  // was on its way
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{2}, LeaseId{3}));
  bench_.ReturnsHeard({LeaseId{2}, LeaseId{3}});
  EXPECT_FALSE(*task->stop);
  Finish(*task);
  bench_.ResultsAnswered(Results());
  EXPECT_TRUE(bench_.AwaitIdle(milliseconds(0)));
}

TEST_F(WorkbenchTest, StoppingReturnsWhatRuns) {
  bench_.AddLeases({MakeLease(1)}, {});
  const auto task = bench_.AwaitUnit({});
  bench_.StopRendering();
  EXPECT_TRUE(*task->stop);
  EXPECT_THAT(State().returned_leases, ElementsAre(LeaseId{1}));
}

TEST_F(WorkbenchTest, TheStateIsToldSeveralTimesInTheLifeOfALease) {
  EXPECT_EQ(State().wait, kSynchronizeWaitMax);
  bench_.AddLeases({MakeLease(1)}, {});
  EXPECT_EQ(State().wait, milliseconds(1000));  // a third of its 3 s
}

TEST_F(WorkbenchTest, WaitingEndsWithTheWorker) {
  std::stop_source stop;
  std::thread slot([&] { EXPECT_FALSE(bench_.AwaitUnit(stop.get_token())); });
  std::thread loader([&] { EXPECT_FALSE(bench_.AwaitSceneOrder(stop.get_token())); });
  std::thread returner(
      [&] { EXPECT_TRUE(std::holds_alternative<std::monostate>(bench_.AwaitParcel(0, stop.get_token()))); });
  stop.request_stop();
  slot.join();
  loader.join();
  returner.join();
}

}  // namespace
}  // namespace tessera
