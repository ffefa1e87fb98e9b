// Pictures that are watched while their files cannot be read.
#include "coordinator/web/api/picture_boards.h"

#include <gtest/gtest.h>

#include <atomic>
#include <new>

#include "coordinator/web/api/encoded_picture.h"
#include "renderer/film/merger.h"
#include "tests/coordinator/web/api/shown_picture.h"
#include "tests/sanitizers.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kPatience{kSlowdown * 20};

// A farm with one frame, whose picture is finished.
class WatchedFile : public testing::Test {
 protected:
  WatchedFile() {
    FrameSpec& frame = spec_.frames.emplace_back().spec;
    frame.width = frame.height = 8;
    frame.crop = {0, 0, 8, 8};
    frame.tile_size = 8;
    frame.samples_per_pixel = 1;
    frame.exr_type = ExrType::kFloat;
    Merger merger(frame);
    std::vector<float> sums;
    for (int pixel = 0; pixel < 64; ++pixel) sums.insert(sums.end(), {0.5f, 0.5f, 0.5f, 1});
    EXPECT_TRUE(merger.Add({0, {0, 1}, std::move(sums)}));
    file_ = *EncodeExr(frame, merger.Snapshot().Picture());
    farm_.frame = [this](JobId, uint32_t) -> WebResult<FrameState> {
      FrameState state;
      state.status.state = has_failed_ ? JobState::kRunning : JobState::kFinished;
      state.status.frames_total = 1;
      state.spec = std::make_shared<const JobSpec>(spec_);
      state.has_failed = has_failed_;
      if (!has_failed_) state.file = PictureFile{Sha256(file_), file_.size()};
      return state;
    };
    farm_.read = [this](JobId, uint32_t, const auto&) -> WebResult<std::string> {
      ++reads_;
      if (throws_) throw std::bad_alloc();
      if (is_damaged_) return WebError{503, "the picture is damaged"};
      return file_;
    };
  }
  // Receives what is sent until `is_enough`.
  template <typename Condition>
  void Receive(BodyStream& stream, Condition is_enough) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!is_enough() && std::chrono::steady_clock::now() < deadline) {
      std::vector<BodyStream::Part> parts;
      if (stream.Take(parts) != BodyStream::Next::kParts)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      for (const auto& part : parts) shown_.Read(*part);
    }
    EXPECT_TRUE(is_enough());
  }

  JobSpec spec_;
  std::string file_;
  std::atomic<bool> is_damaged_{false}, throws_{false}, has_failed_{false};
  std::atomic<int> reads_{0};
  WebFarm farm_;
  ShownPicture shown_;
};

TEST_F(WatchedFile, OneThatIsMadeAgainIsShownAndWhyItWasNot) {
  is_damaged_ = true;
  PictureBoards boards(farm_);
  const auto watched = boards.Watch({JobId{1}, 0});
  BodyStream& stream = *std::get<std::shared_ptr<BodyStream>>(watched);
  Receive(stream, [&] { return shown_.problem == "the picture is damaged"; });
  EXPECT_EQ(shown_.frames, 0);
  is_damaged_ = false;
  Receive(stream, [&] { return shown_.problem.empty() && shown_.frames == 1 && shown_.is_finished; });
  ASSERT_FALSE(shown_.values.empty());
  EXPECT_EQ(shown_.values[0], 0.5f);
}

TEST_F(WatchedFile, LackOfMemoryIsTheReasonAndEndsNothing) {
  throws_ = true;
  PictureBoards boards(farm_);
  boards.Thumbnail({JobId{1}, 0});
  const auto watched = boards.Watch({JobId{1}, 0});
  BodyStream& stream = *std::get<std::shared_ptr<BodyStream>>(watched);
  Receive(stream, [&] { return shown_.problem == "the coordinator is out of memory" && reads_ > 1; });
  throws_ = false;
  Receive(stream, [&] { return shown_.frames == 1; });
}

TEST_F(WatchedFile, WhatWasRenderedOfAFrameThatFailedIsShownWhileItsJobIsOpen) {
  has_failed_ = true;
  PictureBoards boards(farm_);
  const auto watched = boards.Watch({JobId{1}, 0});
  Receive(*std::get<std::shared_ptr<BodyStream>>(watched), [&] { return shown_.frames == 1; });
  EXPECT_FALSE(shown_.is_finished);
  FrameState state = std::get<FrameState>(farm_.frame(JobId{1}, 0));
  EXPECT_EQ(std::get<std::string>(EncodedPicture(farm_, {JobId{1}, 0}, state, false)), file_);
  state.has_failed = false;
  EXPECT_TRUE(std::holds_alternative<WebError>(EncodedPicture(farm_, {JobId{1}, 0}, state, false)));
}

TEST_F(WatchedFile, OneThatIsTooLargeHasAReason) {
  FrameSpec& frame = spec_.frames[0].spec;
  frame.width = frame.height = 5000;
  frame.crop = {0, 0, 5000, 5000};
  PictureBoards boards(farm_);
  const auto watched = boards.Watch({JobId{1}, 0});
  Receive(*std::get<std::shared_ptr<BodyStream>>(watched), [&] {
    return shown_.problem == "the picture is too large to be shown here; download the EXR file";
  });
  EXPECT_EQ(reads_, 0);
}

}  // namespace
}  // namespace tessera
