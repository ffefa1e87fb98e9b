#include "worker/core/scene_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/worker/tiny_scene.h"

namespace tessera {
namespace {

using testing::ElementsAre;

const SceneTable::TimePoint kTableStart{};

Digest Key(uint8_t number) {
  Digest digest;
  digest.bytes[0] = number;
  return digest;
}

SceneRequest Order(uint8_t number) {
  SceneRequest order;
  order.key = Key(number);
  return order;
}

bool NotInUse(const Digest&) {
  return false;
}

std::vector<Digest> Keys(const SceneTable& shelf) {
  std::vector<Digest> keys;
  for (const HeldScene& held : shelf.Held()) keys.push_back(held.key);
  return keys;
}

void LoadAll(SceneTable& shelf) {
  while (const auto order = shelf.StartLoading(kTableStart)) shelf.Loaded(order->key, LoadTinyScene());
}

TEST(SceneTable, LoadsTheMostUrgentFirstAndEachOnce) {
  SceneTable shelf;
  shelf.Want({Order(2), Order(1)}, NotInUse);
  EXPECT_EQ(shelf.StartLoading(kTableStart)->key, Key(2));
  shelf.Want({Order(2), Order(1)}, NotInUse);  // told again meanwhile
  EXPECT_EQ(shelf.StartLoading(kTableStart)->key, Key(1));
  EXPECT_FALSE(shelf.StartLoading(kTableStart));
  EXPECT_FALSE(shelf.IsReady(Key(2)));
  shelf.Loaded(Key(2), LoadTinyScene());
  EXPECT_TRUE(shelf.IsReady(Key(2)));
  EXPECT_NE(shelf.Use(Key(2)), nullptr);
  EXPECT_EQ(shelf.Use(Key(1)), nullptr);
}

TEST(SceneTable, EvictsTheLeastRecentlyUsedThatIsNeitherWantedNorInUse) {
  SceneTable shelf;
  for (uint8_t i = 1; i <= kScenesHeldMax + 1; ++i) {
    shelf.Want({Order(i)}, NotInUse);
    LoadAll(shelf);
  }
  EXPECT_EQ(Keys(shelf).size(), kScenesHeldMax + 1);  // the last came after the shelf was tidied
  shelf.Use(Key(1));
  const auto second_in_use = [](const Digest& key) { return key == Key(2); };
  shelf.Want({Order(3)}, second_in_use);
  EXPECT_THAT(Keys(shelf), ElementsAre(Key(1), Key(2), Key(3), Key(5)));
}

TEST(SceneTable, AFailedSceneIsRetriedAfterAnIntervalIfStillWanted) {
  SceneTable shelf;
  shelf.Want({Order(1)}, NotInUse);
  shelf.StartLoading(kTableStart);
  shelf.Failed(Key(1), kTableStart);
  EXPECT_TRUE(shelf.Held().empty());
  EXPECT_FALSE(shelf.StartLoading(kTableStart));
  EXPECT_EQ(shelf.NextRetry(), kTableStart + kSceneRetryInterval);
  EXPECT_TRUE(shelf.StartLoading(kTableStart + kSceneRetryInterval));
  shelf.Failed(Key(1), kTableStart);
  shelf.Want({}, NotInUse);
  EXPECT_FALSE(shelf.NextRetry());
  EXPECT_FALSE(shelf.StartLoading(kTableStart + kSceneRetryInterval));
}

TEST(SceneTable, ExpectsScenesThatAreWantedLoadingOrReady) {
  SceneTable shelf;
  EXPECT_FALSE(shelf.Expects(Key(1)));
  shelf.Want({Order(1)}, NotInUse);
  EXPECT_TRUE(shelf.Expects(Key(1)));
  LoadAll(shelf);
  shelf.Want({}, NotInUse);
  EXPECT_TRUE(shelf.Expects(Key(1)));
}

}  // namespace
}  // namespace tessera
