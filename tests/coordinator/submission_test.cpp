// Which jobs are accepted, how long checking the files of a scene may take, and on which threads it does.
#include "coordinator/submission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <latch>

#include "proto/scene_package.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/sanitizers.h"

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr std::chrono::milliseconds kSoon{kSlowdown * 20'000};
constexpr std::chrono::milliseconds kNotYet{200};

class Submission : public testing::Test {
 protected:
  Submission() {
    ScenePackage package;
    package.files["scene.pbrt"] = {Sha256("a scene"), 7};
    const std::string manifest = EncodeScenePackage(package);
    spec_.package = Sha256(manifest);
    FrameSpec frame;
    spec_.frames = {{"scene.pbrt", "", frame, 0}};
    const BlobStore before = Open();
    EXPECT_TRUE(before.Write(Sha256("a scene"), "a scene"));
    EXPECT_TRUE(before.Write(spec_.package, manifest));
  }
  // As a coordinator finds it at its start: it has verified nothing.
  BlobStore Open() const {
    return std::move(*BlobStore::Open(folder_ / "blobs", BlobStoreOptions::Origin(1 << 30)));
  }

  const TemporaryDir folder_;
  JobSpec spec_;
};

TEST_F(Submission, FilesThatTakeTooLongAreCheckedInSeveralCalls) {
  const BlobStore blobs = Open();
  const auto late = CheckSubmission(spec_, blobs, std::chrono::seconds(-1));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().kind, ErrorKind::kInterrupted);
  EXPECT_THAT(late.error().message, HasSubstr("still checking"));
  EXPECT_TRUE(CheckSubmission(spec_, blobs));
}

TEST_F(Submission, FilesThatHaveToBeReadDelayNoBriefTask) {
  const BlobStore blobs = Open();
  std::latch end(1);
  FileThreads threads;
  for (int i = 0; i < 2; ++i) threads.lengthy.Post([&] { end.wait(); });
  std::promise<void> read, known;
  auto was_read = read.get_future(), was_known = known.get_future();
  PostCheck(threads, blobs, spec_.package, [&] { read.set_value(); });
  EXPECT_EQ(was_read.wait_for(kNotYet), std::future_status::timeout)
      << "it runs on a thread for lengthy tasks";
  EXPECT_TRUE(CheckSubmission(spec_, blobs));
  PostCheck(threads, blobs, spec_.package, [&] { known.set_value(); });
  EXPECT_EQ(was_known.wait_for(kSoon), std::future_status::ready) << "nothing has to be read any more";
  end.count_down();
  EXPECT_EQ(was_read.wait_for(kSoon), std::future_status::ready);
  threads.Stop();
}

FrameRequest SquareFrame(int side, int tile_size) {
  FrameSpec spec;
  spec.width = spec.height = side;
  spec.crop = {0, 0, side, side};
  spec.tile_size = tile_size;
  return {"a.pbrt", "", spec, 0};
}

TEST(SubmittedFrames, AFrameOfMoreThanAMillionTilesIsRefused) {
  EXPECT_TRUE(CheckFrames({SquareFrame(16'384, kTileSizeDefault)}));
  EXPECT_TRUE(CheckFrames({SquareFrame(65'536, 64)}));
  EXPECT_TRUE(CheckFrames({SquareFrame(16'384, 16)}));
  const auto refused = CheckFrames({SquareFrame(16'384, kTileSizeDefault), SquareFrame(16'384, 8)});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(refused.error().message, HasSubstr("a.pbrt: tiles of 8 pixels cut the frame into 4194304"));
  EXPECT_THAT(refused.error().message, HasSubstr("--tile-size"));
}

}  // namespace
}  // namespace tessera
