#include "coordinator/core/picture_queue.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using std::chrono::seconds;

FrameId Frame(uint32_t frame) {
  return {JobId{1}, frame};
}

TEST(PictureQueue, HoldsPicturesUpToItsLimitAndOneThatIsLarger) {
  PictureQueue queue(100);
  EXPECT_TRUE(queue.Hold(Frame(0), 60));
  EXPECT_FALSE(queue.Hold(Frame(1), 60));
  EXPECT_TRUE(queue.Hold(Frame(2), 40));
  EXPECT_EQ(queue.held_bytes(), 100u);
  queue.Release(Frame(0));
  queue.Release(Frame(1));
  EXPECT_EQ(queue.held_bytes(), 40u);
  queue.Release(Frame(2));
  EXPECT_TRUE(queue.Hold(Frame(3), 1000)) << "alone, it may be larger than the limit";
}

TEST(PictureQueue, PicturesWaitUntilTheyAreDueAndThereIsRoom) {
  PictureQueue queue(100);
  ASSERT_TRUE(queue.Hold(Frame(0), 60));
  queue.Wait(Frame(1), 60, seconds(5));
  queue.Wait(Frame(2), 30, seconds(7));
  EXPECT_EQ(queue.TakeDue(seconds(6)), std::nullopt);
  EXPECT_EQ(queue.next_due(), std::nullopt) << "waking up before there is room is useless";
  queue.Release(Frame(0));
  EXPECT_EQ(queue.next_due(), seconds(5));
  EXPECT_EQ(queue.TakeDue(seconds(4)), std::nullopt);
  EXPECT_EQ(queue.TakeDue(seconds(6)), Frame(1));
  EXPECT_EQ(queue.TakeDue(seconds(6)), std::nullopt);
  EXPECT_EQ(queue.TakeDue(seconds(7)), Frame(2));
  EXPECT_EQ(queue.held_bytes(), 90u);
}

}  // namespace
}  // namespace tessera
