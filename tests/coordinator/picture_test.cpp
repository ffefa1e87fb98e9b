// Pictures that are damaged between their writing and their fetching.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "renderer/util/file.h"
#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/no_new_files.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;

class Pictures : public Services {
 protected:
  // Renders a job and returns its picture.
  std::string Finish() {
    job = Submit();
    for (const uint32_t tile : {0u, 1u}) {
      proto::ResultsAnswer answer;
      EXPECT_TRUE(Return(job, tile, {0, 4}, answer).ok());
    }
    std::string bytes;
    EXPECT_TRUE(FetchSoon(bytes).ok());
    return bytes;
  }
  // Tries again while the coordinator says that this helps.
  grpc::Status FetchSoon(std::string& bytes) {
    grpc::Status status;
    ComesTrue([&] {
      bytes.clear();
      status = Fetch(job, false, bytes);
      const bool is_early = status.error_message().find("not finished") != std::string::npos;
      return !is_early && status.error_code() != StatusCode::UNAVAILABLE;
    });
    return status;
  }
  // A job whose picture has more bytes than a chunk: no two pixels are alike.
  void RenderLarge() {
    proto::JobSpec message = PrepareJob();
    JobSpec spec = *ReadJobSpec(message);
    FrameSpec& frame = spec.frames[0].spec;
    frame.width = 512;
    frame.height = 256;
    frame.crop = {0, 0, frame.width, frame.height};
    frame.tile_size = 64;
    message.Clear();
    Write(spec, message);
    scene_key = SceneKey(spec.package, "scene.pbrt", "", frame);
    proto::SubmitAnswer submitted;
    ASSERT_TRUE(Call(*jobs, &proto::Jobs::Stub::Submit, message, submitted).ok());
    job = submitted.job();
    std::minstd_rand random(1);
    std::uniform_real_distribution<float> values;
    for (uint32_t tile = 0; tile < static_cast<uint32_t>(frame.TileCount()); ++tile) {
      RadianceTile radiance{frame.TileBounds(static_cast<int>(tile)), {0, 4}, {4}, {}};
      for (int pixel = 0; pixel < 64 * 64; ++pixel) {
        for (int c = 0; c < 3; ++c) radiance.sums.push_back(4 * values(random));
        radiance.sums.push_back(4);
      }
      proto::ResultsAnswer answer;
      ASSERT_TRUE(Return(ResultOf(job, tile, {0, 4}, EncodeRadianceTile(radiance)), answer).ok());
    }
  }
  std::string Path() const { return folder / ("data/pictures/" + std::to_string(job) + "/0.exr"); }
  void Cut() const { std::filesystem::resize_file(Path(), std::filesystem::file_size(Path()) / 2); }
  void Flip() const {
    std::fstream file(Path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(Path()) / 2));
    file.put('\x5a');
  }

  uint64_t job = 0;
};

TEST_F(Pictures, ADamagedPictureIsMadeAgainAndNeverSent) {
  const std::string picture = Finish();
  const std::vector<std::function<void()>> damages{[&] { Flip(); }, [&] { Cut(); },
                                                   [&] { std::filesystem::remove(Path()); }};
  for (const auto& damage : damages) {
    damage();
    std::string bytes;
    const grpc::Status status = FetchSoon(bytes);
    EXPECT_TRUE(status.ok()) << status.error_message();
    EXPECT_TRUE(bytes == picture);
    EXPECT_EQ(Status(job).state(), proto::JOB_STATE_FINISHED);
  }
}

TEST_F(Pictures, AFinishedPictureOfAnySizeIsSentFromAFullDisk) {
  RenderLarge();
  std::string picture;
  ASSERT_TRUE(FetchSoon(picture).ok());
  ASSERT_GT(picture.size(), static_cast<size_t>(kChunkBytesMax));
  const NoFileGrows full;
  std::string bytes;
  const grpc::Status status = Fetch(job, false, bytes);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(bytes == picture);
}

TEST_F(Pictures, APictureThatCannotBeOpenedForLackOfDescriptorsIsNotLost) {
  const std::string picture = Finish();
  coordinator.reset();
  std::filesystem::remove_all(folder / "data/spool");
  Start();
  std::string bytes;
  ASSERT_TRUE(FetchSoon(bytes).ok()) << "from now on there is a connection";
  {
    const NoNewFiles none;
    const grpc::Status status = Fetch(job, false, bytes);
    EXPECT_EQ(status.error_code(), StatusCode::UNAVAILABLE) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("Too many open files"));
  }
  EXPECT_EQ(Status(job).reason(), "") << "it is not lost";
  ASSERT_TRUE(FetchSoon(bytes).ok());
  EXPECT_TRUE(bytes == picture);
}

TEST_F(Pictures, APictureThatWasCutOrRemovedIsMadeAgainAfterAStart) {
  const std::string picture = Finish();
  coordinator.reset();
  std::filesystem::remove(Path());
  Start();
  ASSERT_TRUE(ComesTrue([&] { return std::filesystem::exists(Path()); }));
  EXPECT_EQ(*ReadFile(Path(), 1 << 20), picture) << "nobody has asked for it";
}

TEST_F(Pictures, APictureWithoutSumsIsReportedAsLostUntilItIsThere) {
  const std::string picture = Finish();
  coordinator.reset();
  std::filesystem::remove_all(folder / "data/spool");
  std::filesystem::rename(Path(), folder / "away");
  Start();
  std::string bytes;
  const grpc::Status status = FetchSoon(bytes);
  EXPECT_EQ(status.error_code(), StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(),
              testing::AllOf(HasSubstr("is lost"), HasSubstr("submit the scene again")));
  EXPECT_THAT(Status(job).reason(), HasSubstr("is lost"));
  std::filesystem::rename(folder / "away", Path());
  ASSERT_TRUE(FetchSoon(bytes).ok());
  EXPECT_TRUE(bytes == picture);
  EXPECT_EQ(Status(job).reason(), "");
}

TEST_F(Pictures, AStartThatFailsWhileAPictureIsWrittenLeavesNothingRunning) {
  job = Submit();
  for (const uint32_t tile : {0u, 1u}) {
    proto::ResultsAnswer answer;
    ASSERT_TRUE(Return(job, tile, {0, 4}, answer).ok());
  }
  coordinator.reset();
  for (int i = 0; i < 20; ++i) {
    CoordinatorOptions options = OptionsOf("data");
    options.listen = {*ParseAddress("unix:" + (folder / "missing/socket"), "test")};
    EXPECT_FALSE(Coordinator::Start(options));
  }
  Start();
  std::string bytes;
  EXPECT_TRUE(FetchSoon(bytes).ok());
}

}  // namespace
}  // namespace tessera
