#include "client/live/preview_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "client/output/picture_encoder.h"
#include "renderer/util/file.h"
#include "tests/client/live/live_pictures.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(PreviewFile, IsTonemappedAsOtherPicturesAndReplaced) {
  const TemporaryDir folder;
  const std::string path = folder / "preview.png";
  PreviewFile preview(path);
  for (const float seed : {0.0f, 1.0f}) {
    const LoadedPicture picture = PictureOf(20, 10, seed);
    ASSERT_TRUE(preview.Show({0, picture}, {}));
    EXPECT_EQ(*ReadFile(path, 1 << 20), *EncodeAs(PictureFormat::kPng, picture, path));
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
      << "nothing is left over";
}

TEST(PreviewFile, AFolderThatIsMissingIsAnErrorOfThisPictureAlone) {
  const TemporaryDir folder;
  PreviewFile preview(folder / "later/preview.png");
  EXPECT_FALSE(preview.Show({0, PictureOf(2, 2, 1)}, {}));
  std::filesystem::create_directory(folder / "later");
  EXPECT_TRUE(preview.Show({0, PictureOf(2, 2, 1)}, {}));
}

TEST(CheckPreview, RefusesFilesThatTheCommandReadsOrWrites) {
  const TemporaryDir folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "texture.png", "texture"));
  const auto check = [&](const std::string& path) -> std::string {
    const auto checked = CheckPreview(path, {folder / "texture.png"}, {folder / "out.png"});
    return checked ? "" : checked.error().message;
  };
  EXPECT_EQ(check(folder / "preview.png"), "");
  EXPECT_EQ(check(folder / "preview.JPG"), "");
  EXPECT_EQ(check(folder / "not-there/preview.png"), "");
  EXPECT_NE(check(folder / "texture.png"), "");
  EXPECT_NE(check(folder / "./out.png"), "");
  EXPECT_THAT(check(folder / "preview.exr"), HasSubstr("must end in .png or .jpg"));
  EXPECT_THAT(check("-"), HasSubstr("must end in .png or .jpg"));
}

}  // namespace
}  // namespace tessera
