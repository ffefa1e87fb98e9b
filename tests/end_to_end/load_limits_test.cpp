// Scenes that exceed the limits of a worker.
#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class LoadLimits : public EndToEnd {
 protected:
  // By default it takes less than 16 MiB when it is checked, and more when it is loaded to be rendered.
  std::string WriteLargeScene(int triangles = 100'000) {
    std::string scene =
        "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nShape \"trianglemesh\" \"point3 P\" [";
    for (int i = 0; i < triangles; ++i) scene += " 0 0 5 1 0 5 1 1 5";
    scene += "] \"integer indices\" [";
    for (int i = 0; i < 3 * triangles; ++i) scene += " " + std::to_string(i);
    return Write("large.pbrt", scene + "]\n");
  }
};

TEST_F(LoadLimits, ASceneThatNeedsTooMuchMemoryFailsAndTheWorkerGoesOn) {
  StartCoordinator();
  const std::string large = WriteLargeScene();
  Process& worker = StartWorker("small", 1, {"--scene-memory", "16M"});
  const std::string job = Submit(large, {"--spp", "1", "--resolution", "16x16"});
  ASSERT_TRUE(worker.AwaitErrors("scene_failed"));
  EXPECT_THAT(worker.Errors(), HasSubstr("more than 16 MiB of memory (--scene-memory)"));
  Ask({"cancel", job});
  const std::string other = Submit(BoxScene(), {"--spp", "1"});
  EXPECT_EQ(Ask({"watch", other}).code, 0);
}

TEST_F(LoadLimits, WorkersThatAreTooSmallLeaveASceneToALargerOne) {
  StartCoordinator();
  std::vector<Process*> small;
  for (const char* name : {"small-1", "small-2", "small-3"})
    small.push_back(&StartWorker(name, 1, {"--scene-memory", "16M"}));
  const std::string job = Submit(WriteLargeScene(), {"--spp", "1", "--resolution", "16x16"});
  for (Process* const each : small) ASSERT_TRUE(each->AwaitErrors("scene_failed"));
  StartWorker("large", 1);
  const Outcome watched = Ask({"watch", job});
  EXPECT_EQ(watched.code, 0) << watched.errors;
}

TEST_F(LoadLimits, ASceneThatNeedsTooMuchMemoryIsNotSubmittedOrDescribed) {
  StartCoordinator();
  const std::string large = WriteLargeScene(400'000);
  const std::string reason = large + ": loading the scene needs more than 16 MiB of memory (--scene-memory)";
  for (const char* command : {"submit", "info"}) {
    std::vector<std::string> words{command, large, "--scene-memory", "16M"};
    const Outcome refused = std::string(command) == "info" ? Tessera(words) : Ask(words);
    EXPECT_EQ(refused.code, 1) << command;
    EXPECT_THAT(refused.errors, HasSubstr(reason)) << command;
  }
}

TEST_F(LoadLimits, ASceneThatNeedsTooMuchMemoryFailsInProcessAndOnALocalFarm) {
  const std::string large = WriteLargeScene();
  const std::string reason =
      "large.pbrt: loading the scene needs more than 16 MiB of memory (--scene-memory)";
  for (const auto& [where, error] :
       {std::pair("--in-process", "tessera: " + large.substr(0, large.size() - 10) + reason),
        std::pair("--threads=1", "local-1: " + reason)}) {
    std::vector<std::string> command{"render",       large,   where, "--accelerator",  "bvh", "--spp", "1",
                                     "--resolution", "16x16", "-o",  Path("large.exr")};
    EXPECT_EQ(Tessera(command).code, 0) << where;
    command.insert(command.end(), {"--scene-memory", "16M"});
    const Outcome refused = Tessera(command);
    EXPECT_EQ(refused.code, 1) << where;
    EXPECT_THAT(refused.errors, HasSubstr(error)) << where;
  }
}

}  // namespace
}  // namespace tessera
