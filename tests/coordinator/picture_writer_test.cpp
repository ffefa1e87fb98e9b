// Pictures that are denoised before they are written.
#include "coordinator/picture_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "renderer/denoise/denoise.h"
#include "renderer/film/merger.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Keeps pictures in memory, or refuses them.
class MemoryPictures : public PictureStore {
 public:
  Result<void> Write(JobId job, uint32_t frame, std::string_view bytes) override {
    const std::lock_guard lock(mutex_);
    if (is_full) return Failed("no space left on device");
    files_[{job, frame}] = bytes;
    return {};
  }
  Result<std::string> Read(JobId job, uint32_t frame, const PictureFile&) const override {
    return ReadPartial(job, frame);
  }
  Result<std::string> ReadPartial(JobId job, uint32_t frame) const override {
    const std::lock_guard lock(mutex_);
    const auto found = files_.find({job, frame});
    if (found == files_.end()) return Failed("there is no such picture");
    return found->second;
  }
  Result<StoredPicture> Open(JobId, uint32_t, const std::optional<PictureFile>&) const override {
    return Failed("pictures are in memory");
  }
  Result<void> Probe(JobId, uint32_t, const PictureFile&) const override { return {}; }
  void Remove(JobId job) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(files_, [job](const auto& each) { return each.first.first == job; });
  }
  bool IsEmpty() const {
    const std::lock_guard lock(mutex_);
    return files_.empty();
  }
  std::atomic<bool> is_full = false;

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<JobId, uint32_t>, std::string> files_;  // guarded by mutex_
};

// A complete frame of one tile. Its sums are multiplied by `brightness`.
FinishedPicture Finished(uint64_t job, int size, Denoiser denoiser, float brightness = 1) {
  FrameRequest request;
  FrameSpec& spec = request.spec;
  spec.width = spec.height = size;
  spec.crop = {0, 0, size, size};
  spec.tile_size = size;
  spec.samples_per_pixel = 8;
  spec.exr_type = ExrType::kFloat;
  spec.denoiser = denoiser;
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B", "halves.R", "halves.G", "halves.B", "normal.X",
                           "normal.Y", "normal.Z", "depth.Z"})
    AddChannel(spec.channels, {name, ChannelType::kFloat});
  spec.attributes = {{kSamplesAttribute, "8"}};
  RadianceTile tile{spec.crop, {0, 8}, {static_cast<uint32_t>(spec.Layout().shape().stride())}, {}};
  for (int i = 0; i < size * size; ++i) {
    for (uint32_t c = 0; c < tile.shape.stride(); ++c)
      tile.sums.push_back(8.0f * brightness * static_cast<float>(1 + (i * 7 + i / 5) % 3) / 3);
    tile.sums.back() = 8;  // the filter weight
  }
  Merger merger(spec);
  EXPECT_TRUE(merger.Add(0, std::move(tile)));
  EXPECT_TRUE(merger.Complete());
  JobSpec spec_of_job;
  spec_of_job.frames = {request};
  return {JobId{job}, 0, std::make_shared<const JobSpec>(std::move(spec_of_job)), merger.Snapshot()};
}

class Writer : public testing::Test {
 protected:
  std::future<Result<WrittenPicture>> Write(FinishedPicture picture) {
    const auto promise = std::make_shared<std::promise<Result<WrittenPicture>>>();
    writer.Write(std::move(picture),
                 [promise](Result<WrittenPicture> written) { promise->set_value(std::move(written)); });
    return promise->get_future();
  }
  LoadedPicture Stored(uint64_t job) const { return *DecodeExr(*store.ReadPartial(JobId{job}, 0), "stored"); }

  MemoryPictures store;
  PictureWriter writer{store};
};

TEST_F(Writer, DenoisesCompleteFramesThatAskForIt) {
  auto plain = Write(Finished(1, 32, Denoiser::kNone)),
       denoised = Write(Finished(2, 32, Denoiser::kRegression));
  FinishedPicture partial = Finished(3, 32, Denoiser::kRegression);
  partial.is_complete = false;
  auto unfinished = Write(std::move(partial));
  for (auto* each : {&plain, &denoised, &unfinished}) {
    const auto written = each->get();
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_EQ(written->denoise_failed, "");
  }
  EXPECT_FALSE(Stored(1).attributes.contains(kDenoiserAttribute));
  EXPECT_TRUE(Stored(2).attributes.contains(kDenoiserAttribute));
  EXPECT_TRUE(std::ranges::count(Stored(2).channels, "noisy.R"));
  EXPECT_FALSE(Stored(3).attributes.contains(kDenoiserAttribute));
}

TEST_F(Writer, ReportsAFullDiskAndWritesTheSameLater) {
  store.is_full = true;
  const auto refused = Write(Finished(2, 32, Denoiser::kRegression)).get();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("no space left"));
  store.is_full = false;
  const auto first = Write(Finished(2, 32, Denoiser::kRegression)).get();
  const auto second = Write(Finished(2, 32, Denoiser::kRegression)).get();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->file, second->file);
}

// The sums of another attempt are others here, which shows where its picture is from.
TEST_F(Writer, DoesNotDenoiseARefusedPictureAgain) {
  store.is_full = true;
  FinishedPicture picture = Finished(2, 32, Denoiser::kRegression),
                  other = Finished(2, 32, Denoiser::kRegression, 3);
  other.spec = picture.spec;
  FinishedPicture again = other;
  ASSERT_FALSE(Write(std::move(picture)).get());
  ASSERT_FALSE(Write(std::move(other)).get());
  store.is_full = false;
  ASSERT_TRUE(Write(FinishedPicture(again)).get());
  const LoadedPicture kept = Stored(2);
  ASSERT_TRUE(Write(Finished(2, 32, Denoiser::kRegression)).get());
  EXPECT_EQ(kept.values, Stored(2).values);
  ASSERT_TRUE(Write(std::move(again)).get());
  EXPECT_NE(kept.values, Stored(2).values) << "it was kept until it was written";
}

TEST_F(Writer, DenoisesAnExtendedFrameThoughItsFormerPictureWasRefused) {
  store.is_full = true;
  ASSERT_FALSE(Write(Finished(2, 32, Denoiser::kRegression)).get());
  store.is_full = false;
  ASSERT_TRUE(Write(Finished(2, 32, Denoiser::kRegression, 3)).get());
  const LoadedPicture extended = Stored(2);
  ASSERT_TRUE(Write(Finished(3, 32, Denoiser::kRegression, 3)).get());
  EXPECT_EQ(extended.values, Stored(3).values);
}

TEST_F(Writer, ARemovedJobLeavesNoPicture) {
  auto denoised = Write(Finished(2, 64, Denoiser::kRegression));
  auto plain = Write(Finished(2, 32, Denoiser::kNone));
  writer.Remove(JobId{2});
  EXPECT_TRUE(denoised.get());
  EXPECT_TRUE(plain.get());
  writer.Stop();
  EXPECT_TRUE(store.IsEmpty());
}

TEST_F(Writer, StopsWithoutThePicturesThatItWouldHaveToDenoise) {
  std::vector<std::future<Result<WrittenPicture>>> denoised;
  for (uint64_t job = 1; job <= 20; ++job)
    denoised.push_back(Write(Finished(job, 256, Denoiser::kRegression)));
  auto plain = Write(Finished(99, 32, Denoiser::kNone));
  writer.Stop();
  EXPECT_TRUE(plain.get());
  const auto last = denoised.back().get();
  ASSERT_FALSE(last);
  EXPECT_EQ(last.error().kind, ErrorKind::kInterrupted);
  EXPECT_FALSE(store.ReadPartial(JobId{20}, 0));
}

}  // namespace
}  // namespace tessera
