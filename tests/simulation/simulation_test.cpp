// Thousands of small farms under every mix of faults, and a few large ones. A failing seed is printed; replay
// it with `build/release/bin/simulate --seed N --trace`.
#include "tests/simulation/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "tests/simulation/scale_farm.h"

namespace tessera {
namespace {

constexpr uint64_t kSeeds = 2000;
constexpr uint64_t kShards = 16;  // that run side by side

class Seeds : public testing::TestWithParam<uint64_t> {};

TEST_P(Seeds, EveryJobEndsWithTheRightPictureWhateverFailsAndEachSeedReplaysExactly) {
  for (uint64_t seed = GetParam() + 1; seed <= kSeeds; seed += kShards) {
    const SimulationReport report = Simulation(seed, DrawOptions(seed)).Run();
    for (const std::string& violation : report.violations)
      ADD_FAILURE() << "seed " << seed << " (" << DrawOptions(seed).Text() << ") at " << violation;
    const SimulationReport again = Simulation(seed, DrawOptions(seed)).Run();
    EXPECT_EQ(report.trace.Hex(), again.trace.Hex()) << "seed " << seed << " does not replay";
  }
}

INSTANTIATE_TEST_SUITE_P(Simulation, Seeds, testing::Range(uint64_t{0}, kShards));

TEST(Simulation, WorkersOfAnIllMachineNeverConfirmEachOtherWhileOthersWork) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    SimulationOptions options;
    options.workers = 6;  // on three machines
    options.jobs = 2;
    options.verify_share = 1;
    options.ill_machine = true;
    const SimulationReport report = Simulation(seed, options).Run();
    for (const std::string& violation : report.violations)
      ADD_FAILURE() << "seed " << seed << " at " << violation;
  }
}

// Beside whatever else fails. A healed farm has to wait until it no longer waits for the worker.
TEST(Simulation, JobsOfWhichAWorkerNeverEndsThePreparationAreDoneByOthers) {
  bool has_waited = false;
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    SimulationOptions options = DrawOptions(seed);
    options.workers = 4;
    options.verify_share = 0;
    options.one_lies = false;
    options.ordered_share = 1;
    options.one_never_prepares = true;
    options.healed_limit_s += options.jobs * Seconds(kPreparationDurationMax);
    const SimulationReport report = Simulation(seed, options).Run();
    for (const std::string& violation : report.violations)
      ADD_FAILURE() << "seed " << seed << " at " << violation;
    has_waited |= report.ended_s > Seconds(kPreparationDurationMax);
  }
  EXPECT_TRUE(has_waited);
}

// The end is written before the results that wait, and the coordinator may crash between the two.
TEST(Simulation, JobsAreCancelledWhileTheDiskIsFullAndOthersLoseNothing) {
  int ends_on_full_disk = 0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    SimulationOptions options = DrawOptions(seed);
    options.jobs = std::max(options.jobs, 2);
    options.cancel_one = true;
    options.faults.clear();
    for (double at_s = 1; at_s < options.faults_s; at_s += 12) {
      options.faults.push_back({at_s, FaultKindOf("full_disk")});
      for (const double later_s : {1, 4, 7}) options.faults.push_back({at_s + later_s, FaultKindOf("crash")});
    }
    const SimulationReport report = Simulation(seed, options).Run();
    for (const std::string& violation : report.violations)
      ADD_FAILURE() << "seed " << seed << " at " << violation;
    ends_on_full_disk += report.ends_on_full_disk;
  }
  EXPECT_GT(ends_on_full_disk, 10);
}

class Scale : public testing::TestWithParam<int> {};

TEST_P(Scale, AFarmWithSlowAndDyingMachinesWastesLittle) {
  const ScaleReport report = ScaleFarm(ScaleOptionsFor(GetParam(), 120)).Run();
  ASSERT_TRUE(report.finished);
  EXPECT_LE(report.Ratio(), 1.10) << "makespan over total work / total speed";
  EXPECT_LE(report.Waste(), 0.05) << "samples rendered in vain over all samples";
}

INSTANTIATE_TEST_SUITE_P(Simulation, Scale, testing::Values(10, 100, 1000));

}  // namespace
}  // namespace tessera
