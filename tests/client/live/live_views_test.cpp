#include "client/live/live_views.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "client/live/local_pictures.h"
#include "tests/client/live/live_pictures.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Returns whether the condition holds within a minute.
bool Eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

// Whether a source fails, and how often it was asked for a picture.
struct Asking {
  std::atomic<bool> fails = false;
  std::atomic<int> asked = 0;
};

// A source whose pictures are of frame 1, 2 and so on, and which fails while `fails` is set.
class Counting : public PictureSource {
 public:
  explicit Counting(std::shared_ptr<Asking> asking = std::make_shared<Asking>())
      : asking_(std::move(asking)) {}
  Result<std::optional<LivePicture>> Next(const std::stop_token&) override {
    ++asking_->asked;
    if (asking_->fails) return Failed("the source fails");
    return std::optional(LivePicture{++count_, PictureOf(2, 2, 1)});
  }

 private:
  std::shared_ptr<Asking> asking_;
  int count_ = 0;
};

// Waits in Show until it is stopped if `hangs`.
class Recording : public PictureView {
 public:
  Recording(std::shared_ptr<std::atomic<int>> last, bool hangs) : last_(std::move(last)), hangs_(hangs) {}
  Result<void> Show(const LivePicture& picture, const std::stop_token& stop) override {
    *last_ = picture.frame;
    while (hangs_ && !stop.stop_requested()) std::this_thread::sleep_for(milliseconds(5));
    return Failed("this view fails, too");
  }

 private:
  std::shared_ptr<std::atomic<int>> last_;
  const bool hangs_;
};

TEST(LiveViews, PicturesTakeAtMostATwentiethOfTheTime) {
  EXPECT_EQ(PauseAfter(milliseconds(0)), seconds(1));
  EXPECT_EQ(PauseAfter(milliseconds(50)), seconds(1));
  EXPECT_EQ(PauseAfter(milliseconds(400)), seconds(8));
}

TEST(LiveViews, ShowTheLastPictureAndEnd) {
  auto last = std::make_shared<std::atomic<int>>(0);
  LiveViews views({});
  ASSERT_TRUE(views.Add(std::make_unique<Counting>(), std::make_unique<Recording>(last, false)));
  views.Finish(seconds(60));
  EXPECT_GE(*last, 1);
}

TEST(LiveViews, AViewThatHangsIsStoppedWhenPatienceEnds) {
  auto last = std::make_shared<std::atomic<int>>(0);
  LiveViews views({});
  ASSERT_TRUE(views.Add(std::make_unique<Counting>(), std::make_unique<Recording>(last, true)));
  ASSERT_TRUE(Eventually([&] { return *last > 0; }));
  views.Finish(milliseconds(50));  // returns
  EXPECT_EQ(*last, 1);
}

TEST(LiveViews, AStopEndsThemWithoutTheLastPicture) {
  auto last = std::make_shared<std::atomic<int>>(0);
  std::stop_source stop;
  {
    LiveViews views(stop.get_token());
    ASSERT_TRUE(views.Add(std::make_unique<Counting>(), std::make_unique<Recording>(last, true)));
    EXPECT_TRUE(Eventually([&] { return *last > 0; }));
    stop.request_stop();
  }
  EXPECT_EQ(*last, 1);
}

TEST(LiveViews, ASourceThatFailsIsAskedAgain) {
  auto asking = std::make_shared<Asking>();
  asking->fails = true;
  auto last = std::make_shared<std::atomic<int>>(0);
  LiveViews views({});
  ASSERT_TRUE(views.Add(std::make_unique<Counting>(asking), std::make_unique<Recording>(last, false)));
  EXPECT_TRUE(Eventually([&] { return asking->asked >= 2; }));
  EXPECT_EQ(*last, 0);
  asking->fails = false;
  EXPECT_TRUE(Eventually([&] { return *last > 0; }));
}

FrameSpec DeskFrame() {
  FrameSpec spec;
  spec.width = 4;
  spec.height = 3;
  spec.crop = {0, 0, 4, 3};
  spec.samples_per_pixel = 1;
  return spec;
}

TEST(PictureHandoff, TakesASnapshotOnlyWhenAViewAsks) {
  auto handoff = std::make_shared<PictureHandoff>();
  std::atomic<int> taken = 0;
  const auto take = [&] {
    ++taken;
    return FrameSnapshot(DeskFrame(), {});
  };
  for (int i = 0; i < 100; ++i) handoff->Offer(3, take);
  EXPECT_EQ(taken, 0);
  std::atomic<bool> stop = false;
  std::thread renderer([&] {
    while (!stop) handoff->Offer(3, take);
  });
  LocalPictures source(handoff);
  std::optional<LivePicture> picture;
  while (!picture) {
    auto next = source.Next({});
    ASSERT_TRUE(next) << next.error().message;
    picture = std::move(*next);
  }
  stop = true;
  renderer.join();
  EXPECT_EQ(picture->frame, 3);
  EXPECT_EQ(picture->picture.width, 4);
  EXPECT_EQ(picture->picture.values, std::vector<float>(4 * 3 * 3, 0)) << "black where nothing is rendered";
}

TEST(PictureHandoff, GivesTheFinishedPictureWithoutTheRenderer) {
  auto handoff = std::make_shared<PictureHandoff>();
  FramePicture finished;
  finished.bounds = DeskFrame().crop;
  finished.channels = {"R", "G", "B"};
  finished.values.assign(4 * 3 * 3, 0.5f);
  handoff->Finish(9, *EncodeExr(DeskFrame(), finished));
  LocalPictures source(handoff);
  const auto next = source.Next({});
  ASSERT_TRUE(next && *next);
  EXPECT_EQ((*next)->frame, 9);
  EXPECT_EQ((*next)->picture.values, finished.values);
  EXPECT_FALSE(*source.Next({})) << "once";
}

}  // namespace
}  // namespace tessera
