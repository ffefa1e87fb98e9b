#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tessera
