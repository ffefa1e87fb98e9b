// A data directory of the present format ("tessera-data 6") with jobs that came over the web interface, in
// every state that they can be in. It is kept so that a change of what is stored cannot lose them.
//
// tests/coordinator/store/data/format-6 was left by a coordinator that was killed. Jobs 1 to 3 had been
// prepared by three workers. The scene of all but job 3 is the one in tests/coordinator/store/data/format-4:
//   1  finished: samples_per_pixel 13
//   2  paused in mid-frame, its priority changed from 3 to 7: frames 4-5 at 25/s, samples_per_pixel 65536
//   3  failed: none of the three could read the scene
//   4  preparing: frames 1-9x2 at 29.97/s, samples_per_pixel 4, noise_threshold 0.05, aov albedo, priority -2
//   5  preparing, paused
//   6  cancelled before it was prepared
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/build_paths.h"
#include "tests/coordinator/web_services_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class KeptOrders : public WebServices {
 protected:
  KeptOrders() {
    current_dir = "kept";
    std::filesystem::copy(SourceDir() + "/tests/coordinator/store/data/format-6", folder / current_dir,
                          std::filesystem::copy_options::recursive);
    Restart();
  }
};

TEST_F(KeptOrders, AreInTheStatesInWhichTheyWereLeft) {
  for (int start = 0; start < 2; ++start) {
    const proto::JobState states[] = {proto::JOB_STATE_FINISHED, proto::JOB_STATE_PAUSED,
                                      proto::JOB_STATE_FAILED,   proto::JOB_STATE_PREPARING,
                                      proto::JOB_STATE_PAUSED,   proto::JOB_STATE_CANCELLED};
    const char* names[] = {"finished", "half done", "broken", "next", "paused", "cancelled"};
    const int32_t priorities[] = {0, 7, 0, -2, 0, 0};
    for (uint64_t job = 1; job <= 6; ++job) {
      const proto::JobStatus status = Status(job);
      EXPECT_EQ(status.state(), states[job - 1]) << job;
      EXPECT_EQ(status.name(), names[job - 1]) << job;
      EXPECT_EQ(status.priority(), priorities[job - 1]) << job;
      EXPECT_EQ(status.owner(), "local") << job;
    }
    std::string picture;
    EXPECT_TRUE(Fetch(1, false, picture).ok());
    EXPECT_EQ(Sha256(picture).Hex(), "d52c68769ad2de0cfdd3cea3f51738e54efd0a0a90a33922eba505c724c432c9");
    EXPECT_EQ(Status(2).samples_done(), 5767168u);
    EXPECT_EQ(Status(2).frames_total(), 2u);
    EXPECT_THAT(Status(3).reason(), HasSubstr("first, second, third: broken.pbrt:2:"));
    EXPECT_EQ(Status(4).frames_total(), 0u);
    proto::JobLogRequest request;
    request.set_job(3);
    proto::JobLogAnswer log;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::JobLog, request, log).ok());
    ASSERT_EQ(log.entries_size(), 5);
    EXPECT_THAT(log.entries(1).text(), HasSubstr("worker first did not prepare the scene: broken.pbrt:2:1:"));
    Restart();
  }
}

TEST_F(KeptOrders, ThatWaitForAWorkerArePreparedAsTheyWereOrdered) {
  const proto::PreparationRequest request = AwaitPreparation();
  EXPECT_EQ(request.scene_file(), "corner.pbrt");
  EXPECT_EQ(request.options(), "aov=albedo\nnoise-threshold=0.05\nspp=4\n");
  EXPECT_EQ(request.frames_per_second(), 29.97);
  proto::PreparationReport report;
  const proto::FrameRequest frame = PrepareJob().frames(0);
  for (int number = 1; number <= 9; number += 2) {
    proto::FrameRequest& made = *report.add_frames();
    made = frame;
    made.set_number(number);
    made.set_scene_file("corner.pbrt");
    made.set_options(request.options());
  }
  EXPECT_TRUE(Report(report, request).ok());
  EXPECT_EQ(Status(4).state(), proto::JOB_STATE_WAITING) << Status(4).reason();
  EXPECT_EQ(Status(4).frames_total(), 5u);
  EXPECT_EQ(Post("jobs/5/resume")->status, 200);
  EXPECT_EQ(AwaitPreparation().options(), "");
  EXPECT_EQ(Status(5).state(), proto::JOB_STATE_PREPARING);
}

}  // namespace
}  // namespace tessera
