// Files of the spool name the scene of their frame: what another data directory left under the same numbers
// does not enter the picture.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "coordinator/store/file_spool.h"
#include "renderer/util/digest.h"
#include "renderer/util/file.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const FrameId kSceneFrame{JobId{1}, 0};
const Digest kGreen = Sha256("green"), kRed = Sha256("red");

TileNode SceneNode(uint32_t tile) {
  return {tile, {0, 4}, std::vector<float>{1.0f, static_cast<float>(tile)}};
}

// A coordinator whose job 1 renders a scene; nullopt: of a release that names none.
struct SceneStage {
  using Tiles = std::vector<uint32_t>;
  static Tiles TilesOf(const std::vector<TileNode>& nodes) {
    Tiles tiles;
    for (const TileNode& node : nodes) tiles.push_back(node.tile);
    return tiles;
  }
  void Open(std::optional<Digest> scene) {
    foreign.clear();
    spool.reset();
    spool = *FileSpool::Open(folder.path() + "/spool", [](auto task) { task(); });
    if (!scene) return;
    spool->NameScenes([scene](FrameId frame) { return frame == kSceneFrame ? scene : std::nullopt; },
                      [this](const std::string& path) { foreign.push_back(path); });
  }
  // The tiles that a start finds.
  Tiles Restart(std::optional<Digest> scene) {
    Open(scene);
    std::vector<TileNode> nodes;
    const auto restored =
        spool->Restore(kSceneFrame, [&](TileNode node) { nodes.push_back(std::move(node)); });
    EXPECT_TRUE(restored) << restored.error().message;
    return TilesOf(nodes);
  }
  // Opens the directory as one of an older release.
  void Upgrade(Digest scene) {
    Open(scene);
    ASSERT_TRUE(spool->BindToScenes());
  }
  Tiles Loaded() {
    Tiles tiles;
    spool->Load(kSceneFrame, [&](Result<std::vector<TileNode>> nodes) {
      ASSERT_TRUE(nodes) << nodes.error().message;
      tiles = TilesOf(*nodes);
    });
    return tiles;
  }
  void Keep(uint32_t tile) {
    spool->Append(kSceneFrame, SceneNode(tile));
    ASSERT_TRUE(spool->Sync());
  }
  std::string Path(const std::string& file) const { return folder.path() + "/spool/1-0/" + file; }
  std::string Bytes(const std::string& file) const { return *ReadFile(Path(file), 1 << 20); }
  bool Has(const std::string& file) const { return std::filesystem::exists(Path(file)); }

  TemporaryDir folder;
  std::vector<std::string> foreign;
  std::unique_ptr<FileSpool> spool;
};

TEST(SpoolScene, ResultsOfTheSameSceneAreRestored) {
  SceneStage stage;
  stage.Open(kGreen);
  stage.Keep(0);
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0));
  stage.Keep(1);
  EXPECT_FALSE(stage.Has("segment-2")) << "the segment is continued";
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0, 1));
  EXPECT_THAT(stage.Loaded(), ElementsAre(0, 1));
  EXPECT_THAT(stage.foreign, IsEmpty());
}

TEST(SpoolScene, ResultsOfAnotherSceneAreIgnoredAndTheirFileIsReported) {
  SceneStage stage;
  stage.Open(kRed);
  stage.Keep(0);
  stage.Keep(1);
  EXPECT_THAT(stage.Restart(kGreen), IsEmpty());
  EXPECT_THAT(stage.foreign, ElementsAre(stage.Path("segment-1")));
  EXPECT_THAT(stage.Loaded(), IsEmpty());
}

TEST(SpoolScene, ABaseOfAnotherSceneIsIgnored) {
  SceneStage stage;
  stage.Open(kRed);
  stage.Keep(0);
  stage.spool->Replace(kSceneFrame, {SceneNode(0)});
  ASSERT_TRUE(stage.Has("base-2"));
  stage.Open(kGreen);
  EXPECT_THAT(stage.Loaded(), IsEmpty()) << "also if the frame was not restored before";
  EXPECT_THAT(stage.foreign, ElementsAre(stage.Path("base-2")));
  EXPECT_THAT(stage.Restart(kGreen), IsEmpty());
  EXPECT_THAT(stage.Restart(kRed), ElementsAre(0));
}

TEST(SpoolScene, AFileOfAnotherSceneIsNotAppendedToAndGoesWithTheNextBase) {
  SceneStage stage;
  stage.Open(kRed);
  stage.Keep(0);
  const std::string red = stage.Bytes("segment-1");
  EXPECT_THAT(stage.Restart(kGreen), IsEmpty());
  stage.Keep(5);
  EXPECT_EQ(stage.Bytes("segment-1"), red);
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(5));
  EXPECT_THAT(stage.Loaded(), ElementsAre(5));
  stage.spool->Replace(kSceneFrame, {SceneNode(5)});
  EXPECT_FALSE(stage.Has("segment-1"));
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(5));
  EXPECT_THAT(stage.foreign, IsEmpty());
}

// The process was killed while it wrote the first result.
TEST(SpoolScene, AFileThatOnlyNamesAnotherSceneTakesNoResults) {
  SceneStage stage;
  stage.Open(kRed);
  stage.Keep(0);
  const std::string red = stage.Bytes("segment-1");
  std::ofstream(stage.Path("segment-1"), std::ios::binary) << red.substr(0, red.size() - 1);
  EXPECT_THAT(stage.Restart(kGreen), IsEmpty());
  stage.Keep(5);
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(5));
}

// A directory that an older release left is opened for the first time.
TEST(SpoolScene, ResultsThatNameNoSceneAreBoundToTheirFrameWhenTheDirectoryIsUpgraded) {
  SceneStage stage;
  stage.Open(std::nullopt);
  stage.Keep(0);
  stage.Upgrade(kGreen);
  const std::string name = "segment-1-of-" + kGreen.Hex();
  EXPECT_TRUE(stage.Has(name));
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0));
  stage.Keep(1);
  EXPECT_FALSE(stage.Has("segment-2")) << "the segment is continued";
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0, 1));
  EXPECT_THAT(stage.foreign, IsEmpty());
  EXPECT_THAT(stage.Restart(kRed), IsEmpty());
  EXPECT_THAT(stage.foreign, ElementsAre(stage.Path(name)));
}

TEST(SpoolScene, ABaseThatNamesNoSceneIsBoundToItsFrameWhenTheDirectoryIsUpgraded) {
  SceneStage stage;
  stage.Open(std::nullopt);
  stage.Keep(0);
  stage.spool->Replace(kSceneFrame, {SceneNode(0)});
  stage.Upgrade(kGreen);
  EXPECT_THAT(stage.Loaded(), ElementsAre(0));
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0));
  stage.Keep(1);
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0, 1));
  EXPECT_THAT(stage.foreign, IsEmpty());
  stage.spool->Replace(kSceneFrame, {SceneNode(0), SceneNode(1)});
  EXPECT_FALSE(stage.Has("base-2-of-" + kGreen.Hex())) << "it goes when it is replaced";
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0, 1));
}

TEST(SpoolScene, ResultsThatNameNoSceneAreIgnoredInADirectoryThatWasUpgradedBefore) {
  SceneStage stage;
  stage.Open(std::nullopt);
  stage.Keep(0);
  EXPECT_THAT(stage.Restart(kGreen), IsEmpty());
  EXPECT_THAT(stage.foreign, ElementsAre(stage.Path("segment-1")));
  EXPECT_THAT(stage.Loaded(), IsEmpty());
  stage.Keep(5);
  EXPECT_TRUE(stage.Has("segment-2")) << "the file is not appended to";
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(5));
}

TEST(SpoolScene, AnUpgradeThatWasInterruptedIsCompleted) {
  SceneStage stage;
  stage.Open(std::nullopt);
  stage.Keep(0);
  stage.Upgrade(kGreen);
  std::filesystem::rename(stage.Path("segment-1-of-" + kGreen.Hex()),
                          stage.Path("base-1-of-" + kGreen.Hex()));
  std::ofstream(stage.Path("segment-1"), std::ios::binary) << stage.Bytes("base-1-of-" + kGreen.Hex());
  stage.Upgrade(kGreen);
  EXPECT_TRUE(stage.Has("segment-1-of-" + kGreen.Hex()));
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0, 0));
}

TEST(SpoolScene, AWriteThatFailedDoesNotLoseTheSceneOfTheFile) {
  SceneStage stage;
  stage.Open(kGreen);
  stage.spool->Append(kSceneFrame, SceneNode(0));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{16, before.rlim_max};  // the file's header and no record
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto refused = stage.spool->Sync();
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(refused);
  EXPECT_TRUE(stage.Has("segment-1"));
  EXPECT_TRUE(stage.spool->Sync());
  EXPECT_THAT(stage.Restart(kRed), IsEmpty());
  EXPECT_THAT(stage.Restart(kGreen), ElementsAre(0));
}

TEST(SpoolScene, DamageInAFileOfAnotherSceneIsRefusedAsInAnyOther) {
  SceneStage stage;
  stage.Open(kRed);
  stage.Keep(0);
  stage.Keep(1);
  std::string bytes = stage.Bytes("segment-1");
  bytes[12] = static_cast<char>(bytes[12] ^ 1);
  std::ofstream(stage.Path("segment-1"), std::ios::binary) << bytes;
  stage.Open(kGreen);
  const auto restored = stage.spool->Restore(kSceneFrame, [](TileNode) { FAIL(); });
  ASSERT_FALSE(restored);
  EXPECT_THAT(restored.error().message, HasSubstr("segment-1: damaged at byte 8"));
}

}  // namespace
}  // namespace tessera
