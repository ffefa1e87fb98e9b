// Hundreds of small farms under every mix of faults. A failing seed prints itself: it replays to the last
// event.
#include "tests/simulation/simulation.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

SimulationReport RunSeed(uint64_t seed) {
  return Simulation(seed, DrawOptions(seed)).Run();
}

TEST(Simulation, EveryJobEndsWithTheRightPictureWhateverFails) {
  constexpr uint64_t kSeeds = 400;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SimulationReport report = RunSeed(seed);
    for (const std::string& violation : report.violations)
      ADD_FAILURE() << "seed " << seed << " at " << violation;
  }
}

TEST(Simulation, SameSeedGivesTheSameTrace) {
  constexpr uint64_t kSeeds = 100;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    EXPECT_EQ(RunSeed(seed).trace.Hex(), RunSeed(seed).trace.Hex()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace tessera
