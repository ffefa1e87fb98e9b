// Scenes that exceed the limits of a worker.
#include <gmock/gmock.h>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

using LoadLimits = EndToEnd;

TEST_F(LoadLimits, ASceneThatNeedsTooMuchMemoryFailsAndTheWorkerGoesOn) {
  StartCoordinator();
  std::string mesh =
      "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nShape \"trianglemesh\" \"point3 P\" [";
  for (int i = 0; i < 200'000; ++i) mesh += " 0 0 5 1 0 5 1 1 5";
  const std::string large = Write("large.pbrt", mesh + "] \"integer indices\" [0 1 2]\n");
  Process& worker = StartWorker("small", 1, {"--scene-memory", "16M"});
  const std::string job = Submit(large, {"--spp", "1", "--resolution", "16x16"});
  ASSERT_TRUE(worker.AwaitErrors("scene_failed"));
  EXPECT_THAT(worker.Errors(), HasSubstr("more than 16 MiB of memory (--scene-memory)"));
  Ask({"cancel", job});
  const std::string other = Submit(BoxScene(), {"--spp", "1"});
  EXPECT_EQ(Ask({"watch", other}).code, 0);
}

}  // namespace
}  // namespace tessera
