// What an adaptive frame takes in memory and on disk while its results come in, small and in any order:
// results of few pixels take as much room as those of all.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "coordinator/core/schedule/frame_work.h"
#include "coordinator/store/file_spool.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/renderer/film/adaptive_frames.h"

namespace tessera {
namespace {

const FrameId kFrame{JobId{1}, 0};
constexpr size_t kRecordHead = 36;  // of a node in a log

uint64_t NodeBytes(const std::vector<TileNode>& nodes) {
  uint64_t bytes = 0;
  for (const TileNode& node : nodes) bytes += kRecordHead + node.sums->size() * sizeof(float);
  return bytes;
}

// The coordinator's way of results: leased units come back in any order, are kept in the spool and merged.
class Frame {
 public:
  Frame(uint32_t samples, uint32_t seed) : spec_(AdaptiveSpec(samples, 0.05)), random_(seed) {}

  // Leases up to `held_max` units and returns one of them. False if the frame is complete.
  bool Step(size_t held_max) {
    while (held_.size() < held_max) {
      const auto unit = work_.Take(0, [](uint32_t) { return true; });
      if (!unit) break;
      held_.push_back(*unit);
    }
    if (held_.empty()) return false;
    std::swap(held_[random_() % held_.size()], held_.back());
    Return(held_.back());
    held_.pop_back();
    ++results_;
    return true;
  }
  uint64_t held_bytes() const { return NodeBytes(merger_.AllNodes()); }
  uint64_t disk_bytes() const {
    uint64_t bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "spool"))
      bytes += entry.is_regular_file() ? entry.file_size() : 0;
    return bytes;
  }
  // Of the sums of one picture.
  uint64_t picture_bytes() const {
    return static_cast<uint64_t>(spec_.crop.area()) * spec_.Layout().shape().stride() * sizeof(float);
  }
  uint64_t tile_bytes() const {
    return kRecordHead + static_cast<uint64_t>(spec_.tile_size * spec_.tile_size) *
                             spec_.Layout().shape().stride() * sizeof(float);
  }
  int results() const { return results_; }
  const Merger& merger() const { return merger_; }
  static constexpr uint64_t kSegment = 16 << 10;

 private:
  void Return(const TileSamples& unit) {
    const int tile = static_cast<int>(unit.tile);
    RadianceTile result = RenderNoise(spec_, tile, unit.range, work_.Pixels(unit.tile));
    TileNode node{unit.tile, unit.range, std::move(result.sums)};
    for (const FrameId grown : spool_->Grown()) spool_->Replace(grown, merger_.AllNodes());
    spool_->Append(kFrame, node);
    ASSERT_TRUE(spool_->Sync());
    ASSERT_TRUE(work_.Finish(unit));
    ASSERT_TRUE(merger_.Add(std::move(node)));
    work_.SetGoal(unit.tile, merger_.Goal(tile));
  }

  const FrameSpec spec_;
  TemporaryDir folder_;
  std::unique_ptr<FileSpool> spool_ = *FileSpool::Open(
      folder_ / "spool", [](auto task) { task(); }, kSegment);
  FrameWork work_{spec_};
  Merger merger_{spec_};
  std::vector<TileSamples> held_;
  std::mt19937 random_;
  int results_ = 0;
};

class AdaptiveMemory : public testing::TestWithParam<size_t> {};

TEST_P(AdaptiveMemory, IsFourPicturesAndATileForEachUnitHeldHoweverManyResultsComeIn) {
  Frame frame(256, 1);
  uint64_t most = 0;
  while (frame.Step(GetParam())) {
    most = std::max(most, frame.held_bytes());
    ASSERT_LE(frame.disk_bytes(), 4 * std::max(Frame::kSegment, most) + (8 << 10)) << frame.results();
  }
  ASSERT_TRUE(frame.merger().Complete());
  EXPECT_GT(frame.results(), 300);
  EXPECT_LE(most, 4 * frame.picture_bytes() + GetParam() * frame.tile_bytes());
}

INSTANTIATE_TEST_SUITE_P(Holding, AdaptiveMemory, testing::Values(1, 4, 32));

}  // namespace
}  // namespace tessera
