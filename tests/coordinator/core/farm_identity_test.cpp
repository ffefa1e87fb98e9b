// A result enters only the picture that it was rendered for, whatever happened to the numbers of jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/farm_stage.h"

namespace tessera {
namespace {

constexpr FarmId kFarm{1, 2}, kOtherFarm{3, 4};

struct IdentityStage {
  IdentityStage() { farm.Begin(now); }
  void Step() {
    farm.Advance(now);
    output = farm.TakeOutput();
  }
  // A result as a worker returns it that holds a lease of `from`.
  Verdict Return(const WorkUnit& unit, FarmId from = kFarm) {
    JoinWithFormerLease(farm, now, CallId{++calls}, WorkerId{1}, unit);
    farm.ReturnResults(now, CallId{++calls}, WorkerId{1},
                       {{FormerLease(), unit, 0.1, Ones(unit.range), from}});
    Step();
    return output.results.at(0).verdicts.at(0);
  }
  WorkerState Worker(FarmId from) {
    WorkerState state;
    state.worker = WorkerId{1};
    state.farm = from;
    state.sequence = ++calls;
    state.wait = std::chrono::seconds(2);
    return state;
  }
  const WorkerDirective* Synchronize(const WorkerState& state) {
    farm.Synchronize(now, CallId{++calls}, state);
    Step();
    return output.directives.empty() ? nullptr : &output.directives[0].directive;
  }
  bool IsQuarantined() const {
    const auto workers = farm.Workers(now);
    return workers.at(0).quarantined;
  }

  Instant now = std::chrono::seconds(100);
  Farm farm{SchedulerOptions{kLaterEpoch, 3, 55}, 0, kFarm};
  FarmOutput output;
  uint64_t calls = 0;
};

std::shared_ptr<JobSpec> JobOf(const std::string& package) {
  auto spec = SmallJob(Sha256(package).bytes[0] + uint64_t{1});
  spec->package = Sha256(package);
  return spec;
}

WorkUnit UnitOf(const JobSpec& spec, JobId job, SampleRange range = {0, 4}) {
  const FrameRequest& frame = spec.frames[0];
  return {job, 0, 0, range, SceneKey(spec.package, frame.scene_file, frame.options, frame.spec)};
}

TEST(FarmIdentity, AResultOfAnotherSceneWithTheSameNumbersIsObsolete) {
  IdentityStage stage;
  const auto green = JobOf("green"), red = JobOf("red");
  const JobId job = *stage.farm.Submit(stage.now, green);
  EXPECT_EQ(stage.Return(UnitOf(*red, job)), Verdict::kObsolete);
  EXPECT_EQ(stage.farm.Status(stage.now, job)->samples_done, 0u);
  EXPECT_EQ(stage.Return(UnitOf(*green, job)), Verdict::kAccepted);
  EXPECT_EQ(stage.farm.Status(stage.now, job)->samples_done, 256u);
  EXPECT_EQ(stage.Return(UnitOf(*red, job)), Verdict::kObsolete) << "also of a frame that is complete";
}

TEST(FarmIdentity, AResultOfTheSameSceneWithOtherSettingsIsObsolete) {
  IdentityStage stage;
  const auto spec = JobOf("green");
  const auto finer = std::make_shared<JobSpec>(*spec);
  finer->frames[0].spec.samples_per_pixel = 8;
  const JobId job = *stage.farm.Submit(stage.now, spec);
  EXPECT_EQ(stage.Return(UnitOf(*finer, job)), Verdict::kObsolete);
  const auto other = std::make_shared<JobSpec>(*spec);
  other->frames[0].options = "seed=2\n";
  EXPECT_EQ(stage.Return(UnitOf(*other, job)), Verdict::kObsolete);
}

TEST(FarmIdentity, AResultOfAnotherFarmIsObsolete) {
  IdentityStage stage;
  const auto spec = JobOf("green");
  const JobId job = *stage.farm.Submit(stage.now, spec);
  EXPECT_EQ(stage.Return(UnitOf(*spec, job), kOtherFarm), Verdict::kObsolete);
  EXPECT_EQ(stage.Return(UnitOf(*spec, job), FarmId{}), Verdict::kObsolete);
  EXPECT_EQ(stage.Return(UnitOf(*spec, job)), Verdict::kAccepted);
}

// The worker did as it was told, by a coordinator that knew more.
TEST(FarmIdentity, ResultsOfAnotherHistoryAreNoFaultOfTheWorker) {
  IdentityStage stage;
  const auto spec = JobOf("green");
  spec->frames[0].extendable = true;
  const JobId job = *stage.farm.Submit(stage.now, spec);
  stage.Synchronize(stage.Worker(kFarm));
  WorkUnit beyond =
      UnitOf(*spec, job, {4, 4});  // the job had been extended before the directory was restored
  WorkUnit unknown = UnitOf(*JobOf("red"), job, {0, 4});
  unknown.frame = 7;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(stage.Return(beyond), Verdict::kObsolete);
    EXPECT_EQ(stage.Return(unknown), Verdict::kObsolete);
    stage.farm.FailUnit(WorkerId{1}, LeaseId{9, 9}, unknown, "it cannot be rendered");
  }
  EXPECT_FALSE(stage.IsQuarantined());
  EXPECT_EQ(stage.farm.Status(stage.now, job)->state, JobState::kWaiting);
}

TEST(FarmIdentity, AHeldLeaseOfAnotherSceneIsDroppedAndNotTakenOver) {
  IdentityStage stage;
  const auto green = JobOf("green"), red = JobOf("red");
  const JobId job = *stage.farm.Submit(stage.now, green);
  WorkerState state = stage.Worker(kFarm);
  const LeaseId foreign{1, 54};  // of another process
  state.leases = {{foreign, UnitOf(*red, job), LeaseStage::kRunning, {}}};
  const WorkerDirective* const directive = stage.Synchronize(state);
  ASSERT_NE(directive, nullptr);
  EXPECT_EQ(directive->drop, std::vector{foreign});
  EXPECT_EQ(stage.farm.scheduler().lease_count(), 0u);
  state.leases = {{foreign, UnitOf(*green, job), LeaseStage::kRunning, {}}};
  ++state.sequence;
  stage.Synchronize(state);
  EXPECT_EQ(stage.farm.scheduler().lease_count(), 1u) << "of the same scene: its work counts";
}

TEST(FarmIdentity, AWorkerOfAnotherFarmIsAnsweredImmediatelyAndItsLeasesAreIgnored) {
  IdentityStage stage;
  const auto spec = JobOf("green");
  const JobId job = *stage.farm.Submit(stage.now, spec);
  for (const FarmId from : {kOtherFarm, FarmId{}}) {
    WorkerState state = stage.Worker(from);
    state.leases = {{LeaseId{1, 54}, UnitOf(*spec, job), LeaseStage::kRunning, {}}};
    const WorkerDirective* const directive = stage.Synchronize(state);
    ASSERT_NE(directive, nullptr);
    EXPECT_EQ(directive->farm, kFarm);
    EXPECT_EQ(stage.farm.scheduler().lease_count(), 0u);
  }
}

TEST(FarmIdentity, IsPartOfTheFacts) {
  IdentityStage stage;
  stage.Step();
  ASSERT_FALSE(stage.farm.Snapshot().empty());
  const Fact fact = *DecodeFact(EncodeFact(stage.farm.Snapshot().front()));
  EXPECT_EQ(std::get<CoordinatorStarted>(fact).farm, kFarm);
}

}  // namespace
}  // namespace tessera
