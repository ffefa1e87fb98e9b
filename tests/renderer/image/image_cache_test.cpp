#include <gtest/gtest.h>

#include <memory>

#include "renderer/image/image.h"
#include "tests/renderer/image/encoded_images.h"
#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

TEST(ImageCache, ReadsAPictureOnceForEachEncoding) {
  MemoryFiles files({{"a.png", Encode("png", 2, 2, 3, Pattern8(2, 2, 3))}});
  ImageCache cache(files);
  const auto first = cache.Get("a.png", {});
  const auto second = cache.Get("a.png", {});
  const auto linear = cache.Get("a.png", ColorEncoding{ColorEncoding::Kind::kLinear, 1});
  ASSERT_TRUE(first && second && linear);
  EXPECT_EQ(*first, *second);
  EXPECT_NE(*first, *linear);
  EXPECT_EQ(files.reads, 2);
  EXPECT_EQ(cache.bytes(), 24u);
}

TEST(ImageCache, AMissingFileIsAnErrorEachTime) {
  MemoryFiles files({{"a.png", Encode("png", 2, 2, 3, Pattern8(2, 2, 3))}});
  ImageCache cache(files);
  EXPECT_FALSE(cache.Get("b.png", {}).has_value());
  const auto again = cache.Get("b.png", {});
  ASSERT_FALSE(again.has_value());
  EXPECT_EQ(again.error().message, "b.png: cannot be opened: No such file or directory");
}

// Pictures of one colour hold far more bytes than their files. One is within the limit, two are not.
class LimitOfAScene : public testing::Test {
 protected:
  static constexpr uint64_t kPictureBytes = uint64_t{3} * 512 * 512;
  static constexpr uint64_t kLimit = kPictureBytes + 1000;
  const std::string png_ = Encode("png", 512, 512, 3, std::vector<uint8_t>(kPictureBytes, 7));
  MemoryFiles files_{{{"a.png", png_}, {"b.png", png_}}, std::make_shared<SharedCache>(kPictureBytes * 4)};
};

TEST_F(LimitOfAScene, CountsPicturesThatAreRecalledAsThoseThatAreDecoded) {
  ASSERT_LT(png_.size() * 2 * kImagesExpansionMax, kLimit) << "the limit is that of small files";
  ImageCache large(files_);
  ASSERT_TRUE(large.Get("a.png", {}) && large.Get("b.png", {}));
  ASSERT_EQ(files_.reads, 2);
  ImageCache small(files_, kLimit);
  EXPECT_TRUE(small.Get("a.png", {}));
  const auto refused = small.Get("b.png", {});
  EXPECT_EQ(files_.reads, 2) << "both pictures are recalled";
  ASSERT_FALSE(refused);
  EXPECT_EQ(
      refused.error().message,
      "b.png: the pictures up to this one hold 1572864 bytes when decoded, at most 787432 are read from "
      "files of " +
          std::to_string(2 * png_.size()) + " bytes");
  EXPECT_FALSE(small.Get("b.png", {})) << "the second time as well";
  EXPECT_TRUE(small.Get("a.png", {})) << "this one was counted before";
}

TEST_F(LimitOfAScene, CountsAPictureOnceWhateverIsRecalledOfIt) {
  ImageCache cache(files_, kLimit);
  EXPECT_TRUE(cache.CountRecalled("a.png", {}, {png_.size(), kPictureBytes}));
  EXPECT_TRUE(cache.Get("a.png", {}));
  EXPECT_TRUE(cache.CountRecalled("a.png", {}, {png_.size(), kPictureBytes}));
  EXPECT_FALSE(cache.CountRecalled("b.png", {}, {png_.size(), kPictureBytes}));
}

}  // namespace
}  // namespace tessera
