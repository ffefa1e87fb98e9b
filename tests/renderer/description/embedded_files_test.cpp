#include "renderer/description/embedded_files.h"

#include <gtest/gtest.h>

#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

const EmbeddedFiles kEmbedded{{"image0.png", std::make_shared<const std::string>("embedded")}};

TEST(SceneFileSource, PrefersEmbeddedFilesToThoseOutside) {
  MemoryFiles outside({{"image0.png", "outside"}, {"wood.png", "wood"}});
  SceneFileSource files(outside, kEmbedded);
  EXPECT_EQ(*files.Read("image0.png"), "embedded");
  EXPECT_EQ(*files.Read("wood.png"), "wood");
  EXPECT_FALSE(files.Read("stone.png"));
}

TEST(SceneFileSource, KeepsWhatIsMadeOfEmbeddedFilesInTheCacheOfTheOtherSource) {
  const auto cache = std::make_shared<SharedCache>(1 << 20);
  MemoryFiles outside({}, cache);
  SceneFileSource(outside, kEmbedded)
      .Keep("image0.png", "number", std::make_shared<const int>(7), sizeof(int));
  const auto kept = SceneFileSource(outside, kEmbedded).Recall<int>("image0.png", "number");
  ASSERT_TRUE(kept);
  EXPECT_EQ(*kept, 7);
  const EmbeddedFiles changed{{"image0.png", std::make_shared<const std::string>("changed")}};
  EXPECT_FALSE(SceneFileSource(outside, changed).Recall<int>("image0.png", "number"));
}

}  // namespace
}  // namespace tessera
