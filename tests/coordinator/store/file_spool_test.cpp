#include "coordinator/store/file_spool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "coordinator/core/byte_codec.h"
#include "coordinator/store/crc32c.h"
#include "renderer/util/file.h"
#include "renderer/util/hash.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/renderer/film/rule_frames.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const FrameId kFrame{JobId{3}, 1};

TileNode Node(uint32_t tile, SampleRange range, size_t values = 8) {
  std::vector<float> sums;
  for (size_t i = 0; i < values; ++i) sums.push_back(static_cast<float>(tile * 1000 + range.begin + i));
  return {tile, range, std::move(sums)};
}

using Nodes = std::vector<TileNode>;

// Bases are written at once: each test is one thread.
struct SpoolStage {
  explicit SpoolStage(uint64_t segment_bytes_min = 1 << 20) : segment_bytes_min(segment_bytes_min) {
    EXPECT_TRUE(Reopen());
  }
  Result<void> Reopen() {
    spool.reset();
    auto opened = FileSpool::Open(
        folder.path() + "/spool", [](auto task) { task(); }, segment_bytes_min);
    if (!opened) return opened.error();
    spool = std::move(*opened);
    return {};
  }
  // What a start finds of the frame.
  Result<Nodes> Restore() {
    if (const auto opened = Reopen(); !opened) return opened.error();
    Nodes nodes;
    const auto restored = spool->Restore(kFrame, [&](TileNode node) { nodes.push_back(std::move(node)); });
    if (!restored) return restored.error();
    return nodes;
  }
  void Keep(TileNode node) {
    spool->Append(kFrame, std::move(node));
    ASSERT_TRUE(spool->Sync());
  }
  Nodes Loaded() {
    Nodes nodes;
    spool->Load(kFrame, [&](Result<Nodes> loaded) {
      if (loaded) nodes = std::move(*loaded);
    });
    return nodes;
  }
  std::string Path(const std::string& file) const { return folder.path() + "/spool/3-1/" + file; }
  std::string Bytes(const std::string& file) const { return *ReadFile(Path(file), 1 << 24); }
  void Put(const std::string& file, const std::string& bytes) const {
    std::ofstream(Path(file), std::ios::binary) << bytes;
  }
  uint64_t BytesOnDisk() const {
    uint64_t bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path() + "/spool")) {
      if (entry.is_regular_file()) bytes += entry.file_size();
    }
    return bytes;
  }
  static constexpr size_t kHeader = 8, kRecord = 20 + 16 + 32;

  TemporaryDir folder;
  uint64_t segment_bytes_min;
  std::unique_ptr<FileSpool> spool;
};

TEST(FileSpool, GivesBackWhatWasSynced) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 4}));
  stage.Keep(Node(7, {4, 2}));
  stage.spool->Append(kFrame, Node(8, {0, 1}));  // lost with the process
  EXPECT_EQ(*stage.Restore(), (Nodes{Node(0, {0, 4}), Node(7, {4, 2})}));
  stage.Keep(Node(9, {0, 1}));
  EXPECT_EQ(stage.Restore()->size(), 3u);
}

TEST(FileSpool, FindsTheFramesThatItHas) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 4}));
  stage.spool->Append({JobId{12}, 0}, Node(0, {0, 4}));
  ASSERT_TRUE(stage.spool->Sync());
  stage.spool->Replace({JobId{12}, 0}, {Node(0, {0, 4})});
  ASSERT_TRUE(stage.Reopen());
  const auto found = stage.spool->Frames();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].frame, kFrame);
  EXPECT_TRUE(found[0].begun);
  EXPECT_EQ(found[1].frame, (FrameId{JobId{12}, 0}));
  EXPECT_FALSE(found[1].begun) << "all of it is in its base";
  EXPECT_EQ(found[1].bytes, SpoolStage::kHeader + SpoolStage::kRecord);
}

TEST(FileSpool, AFrameThatCannotBeListedIsNotTakenForEmpty) {
  SpoolStage stage;
  ASSERT_TRUE(WriteFileAtomically(stage.folder.path() + "/spool/4-1", ""));
  EXPECT_THAT(stage.Reopen().error().message, HasSubstr("/spool/4-1: cannot be listed"));
}

TEST(FileSpool, ASegmentCutAtAnyByteLosesNoRecordBefore) {
  SpoolStage whole;
  for (uint32_t tile = 0; tile < 3; ++tile) whole.Keep(Node(tile, {0, 1}));
  const std::string bytes = whole.Bytes("segment-1");
  ASSERT_EQ(bytes.size(), SpoolStage::kHeader + 3 * SpoolStage::kRecord);
  for (size_t size = SpoolStage::kHeader; size < bytes.size(); ++size) {
    SpoolStage stage;
    stage.Keep(Node(0, {0, 1}));
    stage.Put("segment-1", bytes.substr(0, size));
    const auto nodes = stage.Restore();
    ASSERT_TRUE(nodes) << size;
    EXPECT_EQ(nodes->size(), (size - SpoolStage::kHeader) / SpoolStage::kRecord);
    stage.Keep(Node(9, {0, 1}));
    EXPECT_EQ(stage.Restore()->back(), Node(9, {0, 1})) << size;
  }
}

TEST(FileSpool, AnyFlippedByteBeforeWhatWasSyncedLaterIsRefusedByName) {
  SpoolStage stage;
  for (uint32_t tile = 0; tile < 3; ++tile) stage.Keep(Node(tile, {0, 1}));
  const std::string bytes = stage.Bytes("segment-1");
  for (size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    stage.Put("segment-1", damaged);
    const auto nodes = stage.Restore();
    if (at >= SpoolStage::kHeader + 2 * SpoolStage::kRecord) {
      ASSERT_TRUE(nodes) << at;  // the last batch may always be torn
      EXPECT_EQ(nodes->size(), 2u);
      continue;
    }
    ASSERT_FALSE(nodes) << at;
    EXPECT_THAT(nodes.error().message, HasSubstr("segment-1"));
  }
}

TEST(FileSpool, MovingADamagedFileAwayIsAWayOn) {
  SpoolStage stage(1);
  stage.Keep(Node(0, {0, 1}));
  stage.spool->Replace(kFrame, {Node(0, {0, 1})});
  stage.Keep(Node(1, {0, 1}));
  std::string damaged = stage.Bytes("base-2");
  damaged[40] ^= 1;
  stage.Put("base-2", damaged);
  const auto refused = stage.Restore();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::AllOf(HasSubstr("base-2"), HasSubstr("move the file away")));
  std::filesystem::remove(stage.Path("base-2"));
  EXPECT_EQ(*stage.Restore(), (Nodes{Node(1, {0, 1})}));
}

TEST(FileSpool, ABaseTakesThePlaceOfSegments) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 1}));
  stage.Keep(Node(0, {1, 1}));
  stage.spool->Append(kFrame, Node(5, {0, 1}));  // not synced: in the base all the same
  stage.spool->Replace(kFrame, {Node(0, {0, 2}), Node(5, {0, 1})});
  EXPECT_FALSE(std::filesystem::exists(stage.Path("segment-1")));
  ASSERT_TRUE(stage.spool->Sync());
  EXPECT_EQ(*stage.Restore(), (Nodes{Node(0, {0, 2}), Node(5, {0, 1}), Node(5, {0, 1})}));
}

// A crash between any two steps of a replacement.
TEST(FileSpool, WhatAReplacementLeftHalfDoneDoesNotCount) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 1}));
  const std::string old_segment = stage.Bytes("segment-1");
  stage.Put("base-2.new", "half a ba");
  EXPECT_EQ(*stage.Restore(), (Nodes{Node(0, {0, 1})}));
  EXPECT_FALSE(std::filesystem::exists(stage.Path("base-2.new")));
  stage.spool->Replace(kFrame, {Node(4, {0, 1})});
  stage.Put("segment-1", old_segment);
  EXPECT_EQ(*stage.Restore(), (Nodes{Node(4, {0, 1})})) << "older than the base";
  EXPECT_FALSE(std::filesystem::exists(stage.Path("segment-1")));
}

TEST(FileSpool, ADroppedFrameIsGone) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 1}));
  stage.spool->Drop(kFrame);
  EXPECT_EQ(stage.BytesOnDisk(), 0u);
  EXPECT_TRUE(stage.Restore()->empty());
}

TEST(FileSpool, LoadsWhatWasThereBefore) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 4}));
  stage.spool->Replace(kFrame, {Node(0, {0, 4})});
  ASSERT_TRUE(stage.Reopen());
  EXPECT_EQ(stage.Loaded(), (Nodes{Node(0, {0, 4})}));
}

// However many results come, in any order: four times the larger of a segment and the live nodes.
TEST(FileSpool, LoadsWhatIsInTheNewestSegmentToo) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 4}));
  EXPECT_EQ(stage.Loaded(), (Nodes{Node(0, {0, 4})}));
  stage.Keep(Node(1, {0, 4}));
  EXPECT_EQ(stage.Loaded(), (Nodes{Node(0, {0, 4}), Node(1, {0, 4})}));
}

size_t OpenDescriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<size_t>(std::distance(begin(all), end(all)));
}

TEST(FileSpool, HundredsOfFramesWithResultsHoldAFewDozenDescriptors) {
  SpoolStage stage;
  const size_t before = OpenDescriptors();
  constexpr uint32_t kFrames = 300;
  for (uint32_t f = 0; f < kFrames; ++f) stage.spool->Append({JobId{5}, f}, Node(0, {0, 4}));
  ASSERT_TRUE(stage.spool->Sync());
  EXPECT_LE(OpenDescriptors(), before + kOpenFilesMax);
  for (const uint32_t f : {0u, 150u, kFrames - 1}) stage.spool->Append({JobId{5}, f}, Node(1, {0, 4}));
  ASSERT_TRUE(stage.spool->Sync());
  ASSERT_TRUE(stage.Reopen());
  size_t nodes = 0;
  for (uint32_t f = 0; f < kFrames; ++f)
    ASSERT_TRUE(stage.spool->Restore({JobId{5}, f}, [&](const TileNode&) { ++nodes; }));
  EXPECT_EQ(nodes, kFrames + 3);
  EXPECT_LE(OpenDescriptors(), before + kOpenFilesMax) << "after a restart, too";
}

TEST(FileSpool, DiskUseStaysWithinItsBound) {
  constexpr uint64_t kSegment = 4096;
  SpoolStage stage(kSegment);
  std::map<uint32_t, TileNode> live;
  uint64_t most = 0, live_bytes = 0;
  for (uint32_t i = 0; i < 1500; ++i) {
    const uint32_t tile = static_cast<uint32_t>(Hash(1, i) % (1 + i / 50));
    live[tile] = Node(tile, {i, 1});
    for (const FrameId frame : stage.spool->Grown()) {
      Nodes nodes;
      for (const auto& [index, node] : live) nodes.push_back(node);
      stage.spool->Replace(frame, std::move(nodes));
    }
    stage.Keep(live[tile]);
    live_bytes = live.size() * SpoolStage::kRecord;
    most = std::max(most, stage.BytesOnDisk());
    ASSERT_LE(stage.BytesOnDisk(), 4 * std::max(kSegment, live_bytes) + 2 * SpoolStage::kRecord) << i;
  }
  EXPECT_GT(most, kSegment);
}

TEST(FileSpool, AFailedWriteLosesNothingAndIsTriedAgain) {
  SpoolStage stage;
  std::ofstream(stage.folder.path() + "/spool/3-1") << "a file in the way of the folder";
  stage.spool->Append(kFrame, Node(0, {0, 1}));
  const auto refused = stage.spool->Sync();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("spool/3-1"));
  std::filesystem::remove(stage.folder.path() + "/spool/3-1");
  ASSERT_TRUE(stage.spool->Sync());
  EXPECT_EQ(*stage.Restore(), (Nodes{Node(0, {0, 1})}));
}

// Results wait for room rather than grow without bound.
TEST(FileSpool, WithoutRoomForABaseResultsWaitForIt) {
  SpoolStage stage(1);
  stage.Keep(Node(0, {0, 1}));
  std::filesystem::create_directories(stage.Path("base-2.new/in-the-way"));
  stage.spool->Replace(kFrame, {Node(0, {0, 1})});
  stage.Keep(Node(1, {0, 1}));
  stage.spool->Append(kFrame, Node(2, {0, 1}));
  EXPECT_FALSE(stage.spool->Sync());
  EXPECT_THAT(stage.spool->Grown(), testing::ElementsAre(kFrame));
  std::filesystem::remove_all(stage.Path("base-2.new"));
  stage.spool->Replace(kFrame, {Node(0, {0, 1}), Node(1, {0, 1}), Node(2, {0, 1})});
  ASSERT_TRUE(stage.spool->Sync());
  EXPECT_EQ(stage.Restore()->size(), 4u);
}

// Its last base comes after its last results are synced: they must not wait for it.
TEST(FileSpool, AFrameThatIsCompleteDoesNotWaitForABaseThatFailed) {
  SpoolStage stage(1);
  stage.Keep(Node(0, {0, 1}));
  std::filesystem::create_directories(stage.Path("base-2.new/in-the-way"));
  stage.spool->Replace(kFrame, {Node(0, {0, 1})});
  stage.Keep(Node(1, {0, 1}));
  stage.spool->Append(kFrame, Node(2, {0, 1}));
  EXPECT_FALSE(stage.spool->Sync());
  EXPECT_TRUE(stage.spool->Sync());
  EXPECT_EQ(stage.Restore()->size(), 3u);
}

// The bytes of a log of the spool as releases of version 1 wrote them.
std::string VersionOneLog(const Nodes& nodes) {
  ByteWriter header;
  header.Add32(1);
  std::string file = "TSRS" + header.Take();
  for (const TileNode& node : nodes) {
    ByteWriter head;
    for (const uint32_t value : {node.tile, node.range.begin, node.range.size}) head.Add32(value);
    std::string payload = head.Take();
    payload.append(reinterpret_cast<const char*>(node.sums->data()), node.sums->size() * sizeof(float));
    ByteWriter record;
    record.Add32(static_cast<uint32_t>(payload.size()));
    record.Add64(file.size());
    record.Add32(Crc32c(payload));
    std::string bytes = record.Take();
    ByteWriter check;
    check.Add32(Crc32c(bytes));
    file += bytes + check.Take() + payload;
  }
  return file;
}

TEST(FileSpool, FilesOfVersionOneAreReadAndNeverAppendedTo) {
  SpoolStage stage;
  const Nodes base{Node(0, {0, 4})}, segment{Node(0, {4, 4}), Node(1, {0, 1})};
  const std::string folder = stage.folder.path() + "/spool/3-1";
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/base-2", std::ios::binary) << VersionOneLog(base);
  const std::string old = VersionOneLog(segment);
  std::ofstream(folder + "/segment-2", std::ios::binary) << old << "torn";
  Nodes expected = base;
  expected.insert(expected.end(), segment.begin(), segment.end());
  EXPECT_EQ(*stage.Restore(), expected);
  EXPECT_EQ(*ReadFile(folder + "/segment-2", 1 << 20), old) << "the torn tail is cut off";
  stage.Keep(Node(2, {0, 1}));
  expected.push_back(Node(2, {0, 1}));
  EXPECT_EQ(*stage.Restore(), expected);
  EXPECT_EQ(*ReadFile(folder + "/segment-2", 1 << 20), old);
  EXPECT_TRUE(std::filesystem::exists(folder + "/segment-3"));
}

TEST(FileSpool, NodesKeepTheNamesOfTheirChannels) {
  SpoolStage stage;
  const auto channels = std::make_shared<const std::vector<Channel>>(ColorsAndWeight({"R", "albedo.R"}));
  TileNode node = Node(1, {0, 4});
  node.channels = channels;
  stage.Keep(node);
  stage.Keep(node);
  node.channels = std::make_shared<const std::vector<Channel>>(*channels);  // another list of the same names
  stage.Keep(node);
  Nodes nodes = *stage.Restore();
  ASSERT_EQ(nodes.size(), 3u);
  for (const TileNode& each : nodes) {
    ASSERT_NE(each.channels, nullptr);
    EXPECT_EQ(*each.channels, *channels);
  }
  EXPECT_EQ(nodes[0].channels, nodes[2].channels) << "the list is written once";
  node.channels = std::make_shared<const std::vector<Channel>>(ColorsAndWeight({"R", "G"}));
  stage.Keep(node);
  nodes = *stage.Restore();
  EXPECT_EQ(*nodes[2].channels, *channels);
  EXPECT_EQ(*nodes[3].channels, *node.channels);
}

TEST(FileSpool, ValuesOfEveryRuleSurvive) {
  const FrameSpec spec = RuleSpec(16);
  Merger merger(spec), restored(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile)
    ASSERT_TRUE(merger.Add(tile, RenderRules(spec, tile, {0, 16})));
  SpoolStage stage;
  for (TileNode& node : merger.AllNodes()) stage.Keep(std::move(node));
  Nodes nodes = *stage.Restore();
  for (TileNode& node : nodes) ASSERT_TRUE(restored.Add(std::move(node)));
  EXPECT_EQ(restored.AllNodes(), merger.AllNodes());
  EXPECT_EQ(restored.Picture().values, merger.Picture().values);
}

TEST(FileSpool, ANodeWithoutValuesIsRefusedByName) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 4}, 0));
  const auto restored = stage.Restore();
  ASSERT_FALSE(restored);
  EXPECT_THAT(restored.error().message, HasSubstr("segment-1: does not contain sums of samples; move the"));
}

TEST(FileSpool, AFileOfANewerVersionIsRefusedByName) {
  SpoolStage stage;
  stage.Keep(Node(0, {0, 4}));
  const std::string path = stage.folder.path() + "/spool/3-1/segment-1";
  std::string bytes = *ReadFile(path, 1 << 20);
  bytes[4] = 3;
  std::ofstream(path, std::ios::binary) << bytes;
  const auto restored = stage.Restore();
  ASSERT_FALSE(restored);
  EXPECT_THAT(restored.error().message,
              HasSubstr("segment-1: has version 3; this tessera-coordinator reads"));
}

}  // namespace
}  // namespace tessera
